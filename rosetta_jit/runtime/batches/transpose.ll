; Word `w` of row `r`, at `from + r * stride + 8 * w`, goes to `columns[w] + 8 * r`, unless that column is null. Eight rows at a time, so that each
; column gets a line of the cache. Of steady words nothing is written but whether they are: four numbers each, the word, its value in row 0, what
; it grows by from row to row, and the bits in which any row differs from that.
define void @transpose(ptr noalias %from, i64 %stride, i64 %rows, i64 %words, ptr noalias %columns, i64 %steady.count, ptr noalias %steady) {
  br label %block
block:
  %row = phi i64 [ 0, %0 ], [ %row.8, %block.next ]
  %row.8 = add i64 %row, 8
  %is.whole = icmp sle i64 %row.8, %rows
  br i1 %is.whole, label %word, label %rest
word:
  %w = phi i64 [ 0, %block ], [ %w.next, %word.next ]
  %word.more = icmp slt i64 %w, %words
  br i1 %word.more, label %word.column, label %steady.begin
word.column:
  %is.wanted = call i1 @is_wanted(ptr %columns, i64 %w)
  br i1 %is.wanted, label %word.body, label %word.next
word.body:
  %from.0 = call ptr @cell(ptr %from, i64 %row, i64 %stride, i64 %w)
  %from.1 = getelementptr i8, ptr %from.0, i64 %stride
  %from.2 = getelementptr i8, ptr %from.1, i64 %stride
  %from.3 = getelementptr i8, ptr %from.2, i64 %stride
  %from.4 = getelementptr i8, ptr %from.3, i64 %stride
  %from.5 = getelementptr i8, ptr %from.4, i64 %stride
  %from.6 = getelementptr i8, ptr %from.5, i64 %stride
  %from.7 = getelementptr i8, ptr %from.6, i64 %stride
  %v0 = load i64, ptr %from.0, align 8
  %v1 = load i64, ptr %from.1, align 8
  %v2 = load i64, ptr %from.2, align 8
  %v3 = load i64, ptr %from.3, align 8
  %v4 = load i64, ptr %from.4, align 8
  %v5 = load i64, ptr %from.5, align 8
  %v6 = load i64, ptr %from.6, align 8
  %v7 = load i64, ptr %from.7, align 8
  %to.0 = call ptr @place(ptr %columns, i64 %w, i64 %row)
  %to.1 = getelementptr i64, ptr %to.0, i64 1
  %to.2 = getelementptr i64, ptr %to.0, i64 2
  %to.3 = getelementptr i64, ptr %to.0, i64 3
  %to.4 = getelementptr i64, ptr %to.0, i64 4
  %to.5 = getelementptr i64, ptr %to.0, i64 5
  %to.6 = getelementptr i64, ptr %to.0, i64 6
  %to.7 = getelementptr i64, ptr %to.0, i64 7
  store i64 %v0, ptr %to.0, align 8
  store i64 %v1, ptr %to.1, align 8
  store i64 %v2, ptr %to.2, align 8
  store i64 %v3, ptr %to.3, align 8
  store i64 %v4, ptr %to.4, align 8
  store i64 %v5, ptr %to.5, align 8
  store i64 %v6, ptr %to.6, align 8
  store i64 %v7, ptr %to.7, align 8
  br label %word.next
word.next:
  %w.next = add i64 %w, 1
  br label %word
steady.begin:
  call void @compare(ptr %from, i64 %stride, i64 %row, i64 8, i64 %steady.count, ptr %steady)
  br label %block.next
block.next:
  br label %block
rest:
  %r = phi i64 [ %row, %block ], [ %r.next, %rest.next ]
  %rest.more = icmp slt i64 %r, %rows
  br i1 %rest.more, label %rest.word, label %end
rest.word:
  %rest.w = phi i64 [ 0, %rest ], [ %rest.w.next, %rest.word.next ]
  %rest.word.more = icmp slt i64 %rest.w, %words
  br i1 %rest.word.more, label %rest.column, label %rest.next
rest.column:
  %rest.is.wanted = call i1 @is_wanted(ptr %columns, i64 %rest.w)
  br i1 %rest.is.wanted, label %rest.body, label %rest.word.next
rest.body:
  %rest.from = call ptr @cell(ptr %from, i64 %r, i64 %stride, i64 %rest.w)
  %rest.to = call ptr @place(ptr %columns, i64 %rest.w, i64 %r)
  %value = load i64, ptr %rest.from, align 8
  store i64 %value, ptr %rest.to, align 8
  br label %rest.word.next
rest.word.next:
  %rest.w.next = add i64 %rest.w, 1
  br label %rest.word
rest.next:
  call void @compare(ptr %from, i64 %stride, i64 %r, i64 1, i64 %steady.count, ptr %steady)
  %r.next = add i64 %r, 1
  br label %rest
end:
  ret void
}

define private ptr @cell(ptr %from, i64 %row, i64 %stride, i64 %word) alwaysinline {
  %offset = mul i64 %row, %stride
  %begin = getelementptr i8, ptr %from, i64 %offset
  %cell = getelementptr i64, ptr %begin, i64 %word
  ret ptr %cell
}

define private ptr @place(ptr %columns, i64 %number, i64 %row) alwaysinline {
  %column.at = getelementptr ptr, ptr %columns, i64 %number
  %column = load ptr, ptr %column.at, align 8
  %place = getelementptr i64, ptr %column, i64 %row
  ret ptr %place
}

define private i1 @is_wanted(ptr %columns, i64 %number) alwaysinline {
  %column.at = getelementptr ptr, ptr %columns, i64 %number
  %column = load ptr, ptr %column.at, align 8
  %is.wanted = icmp ne ptr %column, null
  ret i1 %is.wanted
}

define private void @compare(ptr %from, i64 %stride, i64 %row, i64 %rows, i64 %count, ptr %steady) alwaysinline {
  br label %head
head:
  %s = phi i64 [ 0, %0 ], [ %s.next, %end ]
  %more = icmp slt i64 %s, %count
  br i1 %more, label %body, label %done
body:
  %number = mul i64 %s, 4
  %word.at = getelementptr i64, ptr %steady, i64 %number
  %first.at = getelementptr i64, ptr %word.at, i64 1
  %step.at = getelementptr i64, ptr %word.at, i64 2
  %differs.at = getelementptr i64, ptr %word.at, i64 3
  %word = load i64, ptr %word.at, align 8
  %first = load i64, ptr %first.at, align 8
  %step = load i64, ptr %step.at, align 8
  %differs.0 = load i64, ptr %differs.at, align 8
  %grown = mul i64 %row, %step
  %expected.0 = add i64 %first, %grown
  %cell.0 = call ptr @cell(ptr %from, i64 %row, i64 %stride, i64 %word)
  br label %one
one:
  %r = phi i64 [ 0, %body ], [ %r.next, %one ]
  %differs = phi i64 [ %differs.0, %body ], [ %differs.next, %one ]
  %expected = phi i64 [ %expected.0, %body ], [ %expected.next, %one ]
  %cell.at = phi ptr [ %cell.0, %body ], [ %cell.next, %one ]
  %value = load i64, ptr %cell.at, align 8
  %wrong = xor i64 %value, %expected
  %differs.next = or i64 %differs, %wrong
  %expected.next = add i64 %expected, %step
  %cell.next = getelementptr i8, ptr %cell.at, i64 %stride
  %r.next = add i64 %r, 1
  %one.more = icmp slt i64 %r.next, %rows
  br i1 %one.more, label %one, label %end
end:
  store i64 %differs.next, ptr %differs.at, align 8
  %s.next = add i64 %s, 1
  br label %head
done:
  ret void
}
