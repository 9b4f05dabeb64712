; Record streams of logs, walked without the interpreter lock. `walking.py` says what a walk gives and why it stops.
;
; Each walk begins at word 0 of the state, writes a row a message, and leaves in the state: word 0 where it stopped, word 1 why, word 2 the size of the
; record there as far as it is known. Rows are five columns of `room` numbers: channel, log time, publish time, begin and end of the message.
; Every length comes from the file: it is compared, unsigned, with what is left before anything is added to it.

define private i64 @little16(ptr %at) alwaysinline {
  %value = load i16, ptr %at, align 1
  %wide = zext i16 %value to i64
  ret i64 %wide
}

define private i64 @little32(ptr %at) alwaysinline {
  %value = load i32, ptr %at, align 1
  %wide = zext i32 %value to i64
  ret i64 %wide
}

define private i64 @little64(ptr %at) alwaysinline {
  %value = load i64, ptr %at, align 1
  ret i64 %value
}

declare void @llvm.prefetch.p0(ptr, i32, i32, i32)
declare i32 @llvm.bswap.i32(i32)
declare i64 @llvm.bswap.i64(i64)

define private i64 @big32(ptr %at) alwaysinline {
  %value = load i32, ptr %at, align 1
  %swapped = call i32 @llvm.bswap.i32(i32 %value)
  %wide = zext i32 %swapped to i64
  ret i64 %wide
}

define private i64 @big64(ptr %at) alwaysinline {
  %value = load i64, ptr %at, align 1
  %swapped = call i64 @llvm.bswap.i64(i64 %value)
  ret i64 %swapped
}

define private i64 @stop(ptr %state, i64 %at, i64 %why, i64 %size, i64 %count) alwaysinline {
  store i64 %at, ptr %state
  %why.at = getelementptr i64, ptr %state, i64 1
  store i64 %why, ptr %why.at
  %size.at = getelementptr i64, ptr %state, i64 2
  store i64 %size, ptr %size.at
  ret i64 %count
}

define private void @row(ptr %rows, i64 %room, i64 %row, i64 %channel, i64 %log, i64 %publish, i64 %begin, i64 %end) alwaysinline {
  %at.channel = getelementptr i64, ptr %rows, i64 %row
  store i64 %channel, ptr %at.channel
  %at.log = getelementptr i64, ptr %at.channel, i64 %room
  store i64 %log, ptr %at.log
  %at.publish = getelementptr i64, ptr %at.log, i64 %room
  store i64 %publish, ptr %at.publish
  %at.begin = getelementptr i64, ptr %at.publish, i64 %room
  store i64 %begin, ptr %at.begin
  %at.end = getelementptr i64, ptr %at.begin, i64 %room
  store i64 %end, ptr %at.end
  ret void
}

; MCAP: opcode (u8), length (u64), content. Content of a message (opcode 5): channel (u16), sequence (u32), log time (u64), publish time (u64), data.
define i64 @mcap(ptr %data, i64 %size, ptr %state, ptr %rows, i64 %room) {
  %first = load i64, ptr %state
  br label %head
head:
  %at = phi i64 [ %first, %0 ], [ %end, %message ]
  %count = phi i64 [ 0, %0 ], [ %next, %message ]
  %left = sub i64 %size, %at
  %none = icmp eq i64 %left, 0
  br i1 %none, label %done, label %some
some:
  %full = icmp uge i64 %count, %room
  br i1 %full, label %no.room, label %roomy
roomy:
  %short = icmp ult i64 %left, 9
  br i1 %short, label %cut, label %record
record:
  %here = getelementptr i8, ptr %data, i64 %at
  %opcode = load i8, ptr %here, align 1
  %length.at = getelementptr i8, ptr %here, i64 1
  %length = call i64 @little64(ptr %length.at)
  %behind = sub i64 %left, 9
  %is.message = icmp eq i8 %opcode, 5
  br i1 %is.message, label %sized, label %other
sized:
  %outside = icmp ugt i64 %length, %behind
  br i1 %outside, label %cut.long, label %inside
inside:
  %tiny = icmp ult i64 %length, 22
  br i1 %tiny, label %broken, label %message
message:
  %distance = mul i64 %length, 6
  %later = getelementptr i8, ptr %here, i64 %distance
  call void @llvm.prefetch.p0(ptr %later, i32 0, i32 3, i32 1)
  %channel.at = getelementptr i8, ptr %here, i64 9
  %channel = call i64 @little16(ptr %channel.at)
  %log.at = getelementptr i8, ptr %here, i64 15
  %log = call i64 @little64(ptr %log.at)
  %publish.at = getelementptr i8, ptr %here, i64 23
  %publish = call i64 @little64(ptr %publish.at)
  %begin = add i64 %at, 31
  %content = add i64 %at, 9
  %end = add i64 %content, %length
  call void @row(ptr %rows, i64 %room, i64 %count, i64 %channel, i64 %log, i64 %publish, i64 %begin, i64 %end)
  %next = add i64 %count, 1
  br label %head
done:
  %result.done = call i64 @stop(ptr %state, i64 %at, i64 0, i64 0, i64 %count)
  ret i64 %result.done
no.room:
  %result.room = call i64 @stop(ptr %state, i64 %at, i64 1, i64 0, i64 %count)
  ret i64 %result.room
cut:
  %result.cut = call i64 @stop(ptr %state, i64 %at, i64 2, i64 0, i64 %count)
  ret i64 %result.cut
cut.long:
  %result.long = call i64 @stop(ptr %state, i64 %at, i64 2, i64 %length, i64 %count)
  ret i64 %result.long
other:
  %result.other = call i64 @stop(ptr %state, i64 %at, i64 3, i64 %length, i64 %count)
  ret i64 %result.other
broken:
  %result.broken = call i64 @stop(ptr %state, i64 %at, i64 4, i64 %length, i64 %count)
  ret i64 %result.broken
}

; LCM's event log, big-endian: sync word 0xEDA1DA01, number (u64), time in microseconds (i64), length of the channel's name (u32), of the data (u32), name, data.
; The channel of a row is a hash of its name (FNV-1a), which begins with word 3 of the state, so that nobody can make two names of one hash.
define i64 @lcm(ptr %data, i64 %size, ptr %state, ptr %rows, i64 %room) {
  %first = load i64, ptr %state
  %seed.at = getelementptr i64, ptr %state, i64 3
  %seed = load i64, ptr %seed.at
  br label %head
head:
  %at = phi i64 [ %first, %0 ], [ %end, %message ]
  %count = phi i64 [ 0, %0 ], [ %next, %message ]
  %left = sub i64 %size, %at
  %none = icmp eq i64 %left, 0
  br i1 %none, label %done, label %some
some:
  %full = icmp uge i64 %count, %room
  br i1 %full, label %no.room, label %roomy
roomy:
  %short = icmp ult i64 %left, 28
  br i1 %short, label %cut, label %record
record:
  %here = getelementptr i8, ptr %data, i64 %at
  %word = call i64 @big32(ptr %here)
  %in.step = icmp eq i64 %word, 3986807297
  br i1 %in.step, label %sized, label %other
sized:
  %time.at = getelementptr i8, ptr %here, i64 12
  %time.us = call i64 @big64(ptr %time.at)
  %time = mul i64 %time.us, 1000
  %name.length.at = getelementptr i8, ptr %here, i64 20
  %name.length = call i64 @big32(ptr %name.length.at)
  %data.length.at = getelementptr i8, ptr %here, i64 24
  %data.length = call i64 @big32(ptr %data.length.at)
  %length = add i64 %name.length, %data.length
  %behind = sub i64 %left, 28
  %outside = icmp ugt i64 %length, %behind
  br i1 %outside, label %cut.long, label %named
named:
  %name = getelementptr i8, ptr %here, i64 28
  br label %hash
hash:
  %index = phi i64 [ 0, %named ], [ %index.next, %hash.more ]
  %value = phi i64 [ %seed, %named ], [ %value.next, %hash.more ]
  %hashed = icmp eq i64 %index, %name.length
  br i1 %hashed, label %message, label %hash.more
hash.more:
  %char.at = getelementptr i8, ptr %name, i64 %index
  %char = load i8, ptr %char.at, align 1
  %char.wide = zext i8 %char to i64
  %mixed = xor i64 %value, %char.wide
  %value.next = mul i64 %mixed, 1099511628211
  %index.next = add i64 %index, 1
  br label %hash
message:
  %name.begin = add i64 %at, 28
  %begin = add i64 %name.begin, %name.length
  %end = add i64 %begin, %data.length
  call void @row(ptr %rows, i64 %room, i64 %count, i64 %value, i64 %time, i64 %time, i64 %begin, i64 %end)
  %next = add i64 %count, 1
  br label %head
done:
  %result.done = call i64 @stop(ptr %state, i64 %at, i64 0, i64 0, i64 %count)
  ret i64 %result.done
no.room:
  %result.room = call i64 @stop(ptr %state, i64 %at, i64 1, i64 0, i64 %count)
  ret i64 %result.room
cut:
  %result.cut = call i64 @stop(ptr %state, i64 %at, i64 2, i64 0, i64 %count)
  ret i64 %result.cut
cut.long:
  %whole = add i64 %length, 28
  %result.long = call i64 @stop(ptr %state, i64 %at, i64 2, i64 %whole, i64 %count)
  ret i64 %result.long
other:
  %result.other = call i64 @stop(ptr %state, i64 %at, i64 3, i64 0, i64 %count)
  ret i64 %result.other
}

; A bag's records: length of the header (u32), header, length of the data (u32), data. A header is fields: length (u32), that many bytes `name=value`.
; Of a message (op 2) they are op (u8), conn (u32), time (seconds u32, nanoseconds u32), in any order.
define i64 @bag(ptr %data, i64 %size, ptr %state, ptr %rows, i64 %room) {
  %first = load i64, ptr %state
  br label %head
head:
  %at = phi i64 [ %first, %0 ], [ %end, %message ]
  %count = phi i64 [ 0, %0 ], [ %next, %message ]
  %left = sub i64 %size, %at
  %none = icmp eq i64 %left, 0
  br i1 %none, label %done, label %some
some:
  %full = icmp uge i64 %count, %room
  br i1 %full, label %no.room, label %roomy
roomy:
  %short = icmp ult i64 %left, 8
  br i1 %short, label %cut, label %record
record:
  %here = getelementptr i8, ptr %data, i64 %at
  %header.length = call i64 @little32(ptr %here)
  %behind = sub i64 %left, 8
  %header.outside = icmp ugt i64 %header.length, %behind
  br i1 %header.outside, label %cut.header, label %header
header:
  %fields = getelementptr i8, ptr %here, i64 4
  br label %field
field:
  %place = phi i64 [ 0, %header ], [ %place.next, %field.done ]
  %op = phi i64 [ 0, %header ], [ %op.next, %field.done ]
  %conn = phi i64 [ -1, %header ], [ %conn.next, %field.done ]
  %time = phi i64 [ -1, %header ], [ %time.next, %field.done ]
  %unread = sub i64 %header.length, %place
  %read = icmp eq i64 %unread, 0
  br i1 %read, label %sized, label %field.length
field.length:
  %field.short = icmp ult i64 %unread, 4
  br i1 %field.short, label %broken, label %field.known
field.known:
  %field.at = getelementptr i8, ptr %fields, i64 %place
  %length = call i64 @little32(ptr %field.at)
  %field.left = sub i64 %unread, 4
  %field.outside = icmp ugt i64 %length, %field.left
  br i1 %field.outside, label %broken, label %field.whole
field.whole:
  %text = getelementptr i8, ptr %field.at, i64 4
  %place.text = add i64 %place, 4
  %place.next = add i64 %place.text, %length
  switch i64 %length, label %field.done [
    i64 4, label %maybe.op
    i64 9, label %maybe.conn
    i64 13, label %maybe.time
  ]
maybe.op:                                          ; "op=" and one byte
  %op.word = call i64 @little32(ptr %text)
  %op.name = and i64 %op.word, 16777215
  %is.op = icmp eq i64 %op.name, 4026479
  %op.value = lshr i64 %op.word, 24
  %op.found = select i1 %is.op, i64 %op.value, i64 %op
  br label %field.done
maybe.conn:                                        ; "conn=" and four
  %conn.name = call i64 @little32(ptr %text)
  %conn.named = icmp eq i64 %conn.name, 1852731235
  %conn.equals.at = getelementptr i8, ptr %text, i64 4
  %conn.equals = load i8, ptr %conn.equals.at, align 1
  %conn.equal = icmp eq i8 %conn.equals, 61
  %is.conn = and i1 %conn.named, %conn.equal
  %conn.at = getelementptr i8, ptr %text, i64 5
  %conn.value = call i64 @little32(ptr %conn.at)
  %conn.found = select i1 %is.conn, i64 %conn.value, i64 %conn
  br label %field.done
maybe.time:                                        ; "time=" and eight
  %time.name = call i64 @little32(ptr %text)
  %time.named = icmp eq i64 %time.name, 1701669236
  %time.equals.at = getelementptr i8, ptr %text, i64 4
  %time.equals = load i8, ptr %time.equals.at, align 1
  %time.equal = icmp eq i8 %time.equals, 61
  %is.time = and i1 %time.named, %time.equal
  %seconds.at = getelementptr i8, ptr %text, i64 5
  %seconds = call i64 @little32(ptr %seconds.at)
  %nanoseconds.at = getelementptr i8, ptr %text, i64 9
  %nanoseconds = call i64 @little32(ptr %nanoseconds.at)
  %seconds.ns = mul i64 %seconds, 1000000000
  %time.value = add i64 %seconds.ns, %nanoseconds
  %time.found = select i1 %is.time, i64 %time.value, i64 %time
  br label %field.done
field.done:
  %op.next = phi i64 [ %op, %field.whole ], [ %op.found, %maybe.op ], [ %op, %maybe.conn ], [ %op, %maybe.time ]
  %conn.next = phi i64 [ %conn, %field.whole ], [ %conn, %maybe.op ], [ %conn.found, %maybe.conn ], [ %conn, %maybe.time ]
  %time.next = phi i64 [ %time, %field.whole ], [ %time, %maybe.op ], [ %time, %maybe.conn ], [ %time.found, %maybe.time ]
  br label %field
sized:
  %size.at = getelementptr i8, ptr %fields, i64 %header.length
  %data.length = call i64 @little32(ptr %size.at)
  %lengths = add i64 %header.length, %data.length
  %outside = icmp ugt i64 %lengths, %behind
  br i1 %outside, label %cut.long, label %whole
whole:
  %is.message = icmp eq i64 %op, 2
  br i1 %is.message, label %complete, label %other
complete:
  %has.conn = icmp sge i64 %conn, 0
  %has.time = icmp sge i64 %time, 0
  %has.both = and i1 %has.conn, %has.time
  br i1 %has.both, label %message, label %broken
message:
  %behind.header = add i64 %at, 8
  %begin = add i64 %behind.header, %header.length
  %end = add i64 %begin, %data.length
  call void @row(ptr %rows, i64 %room, i64 %count, i64 %conn, i64 %time, i64 %time, i64 %begin, i64 %end)
  %next = add i64 %count, 1
  br label %head
done:
  %result.done = call i64 @stop(ptr %state, i64 %at, i64 0, i64 0, i64 %count)
  ret i64 %result.done
no.room:
  %result.room = call i64 @stop(ptr %state, i64 %at, i64 1, i64 0, i64 %count)
  ret i64 %result.room
cut:
  %result.cut = call i64 @stop(ptr %state, i64 %at, i64 2, i64 0, i64 %count)
  ret i64 %result.cut
cut.header:
  %header.needed = add i64 %header.length, 8
  %result.header = call i64 @stop(ptr %state, i64 %at, i64 2, i64 %header.needed, i64 %count)
  ret i64 %result.header
cut.long:
  %needed = add i64 %lengths, 8
  %result.long = call i64 @stop(ptr %state, i64 %at, i64 2, i64 %needed, i64 %count)
  ret i64 %result.long
other:
  %record.size = add i64 %lengths, 8
  %result.other = call i64 @stop(ptr %state, i64 %at, i64 3, i64 %record.size, i64 %count)
  ret i64 %result.other
broken:
  %result.broken = call i64 @stop(ptr %state, i64 %at, i64 4, i64 0, i64 %count)
  ret i64 %result.broken
}
