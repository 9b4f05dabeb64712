; How holders end, and what of one the next one takes over: its lanes, with the memory that they begin with. A recipe (`making.ll`) keeps a few of
; those that nobody else has, and that are as they were made: whatever shows their memory to Python makes them keep it, in one of the slots that
; must be empty here.
;
; Of lanes (`runtime.lanes`): 24 arena, 40 to 64 and 80, 88, 104, 120, 136, 144 what is made when it is first asked for, 128 the list of those
; that are kept (not set in one that is kept), $LANES_WEAK_LIST list of weak references. Of a bytearray: 48 how often its buffer is exported. Of a list: 16 size,
; 24 items. Of a class (PyTypeObject): 32 size of objects, 48 dealloc, 256 base, 320 free, 392 finalize.

declare void @PyObject_GC_UnTrack(ptr)
declare void @PyObject_GC_Track(ptr)
declare void @PyObject_ClearWeakRefs(ptr)
declare i32 @PyObject_CallFinalizerFromDealloc(ptr)

; The dealloc of holder classes. Classes derived from them come here when they have let go of what is their own. Its address is taken, which
; is no slot that a linker fills, but a distance: only so can the code be linked beforehand, and a warm start does without LLVM.
define dso_local void @end_holder(ptr %self) {
  %type = call ptr @pointer(ptr %self, i64 8)
  %finalize = call ptr @pointer(ptr %type, i64 392)
  %has.end = icmp ne ptr %finalize, null
  br i1 %has.end, label %finish, label %begin
finish:
  %revived = call i32 @PyObject_CallFinalizerFromDealloc(ptr %self)
  %ends = icmp eq i32 %revived, 0
  br i1 %ends, label %begin, label %lives
lives:
  ret void
begin:
  call void @PyObject_GC_UnTrack(ptr %self)
  %weak = call ptr @pointer(ptr %self, i64 $MESSAGE_WEAK_LIST)
  %is.seen = icmp ne ptr %weak, null
  br i1 %is.seen, label %unsee, label %search
unsee:
  call void @PyObject_ClearWeakRefs(ptr %self)
  br label %search
search:
  %class = phi ptr [ %type, %begin ], [ %type, %unsee ], [ %base, %up ]
  %dealloc = call ptr @pointer(ptr %class, i64 48)
  %is.own = icmp eq ptr %dealloc, @end_holder
  br i1 %is.own, label %found, label %up
up:
  %base = call ptr @pointer(ptr %class, i64 256)
  br label %search
found:
  %size = call i64 @word(ptr %class, i64 32)
  br label %head
head:
  %slot = phi i64 [ $MESSAGE_END, %found ], [ %next, %each ]
  %more = icmp slt i64 %slot, %size
  br i1 %more, label %each, label %own
each:
  %next = add i64 %slot, 8
  call void @drop(ptr %self, i64 %slot)
  br label %head
own:
  call void @drop(ptr %self, i64 72)
  call void @drop(ptr %self, i64 80)
  call void @drop(ptr %self, i64 96)
  %lanes = call ptr @pointer(ptr %self, i64 88)
  %has.lanes = icmp ne ptr %lanes, null
  br i1 %has.lanes, label %release, label %free
release:
  call void @put_pointer(ptr %self, i64 88, ptr null)
  %kept = call i1 @stash(ptr %lanes)
  br i1 %kept, label %free, label %lose
lose:
  call void @Py_DecRef(ptr %lanes)
  br label %free
free:
  %release.memory = call ptr @pointer(ptr %type, i64 320)
  call void %release.memory(ptr %self)
  call void @Py_DecRef(ptr %type)
  ret void
}

; Keep lanes, of which the caller gives away a reference, for the next holder; false, and nothing is done, if they are not as they were made, or
; there are enough.
define internal i1 @stash(ptr %lanes) {
  %alone = call i1 @is_spare(ptr %lanes)
  %spares = call ptr @pointer(ptr %lanes, i64 128)
  %are.kept = icmp ne ptr %spares, null
  %may = and i1 %alone, %are.kept
  br i1 %may, label %look, label %no
look:
  %arrays = call i64 @word(ptr %lanes, i64 40)
  %buffers = call i64 @word(ptr %lanes, i64 48)
  %cells = call i64 @word(ptr %lanes, i64 56)
  %hidden = call i64 @word(ptr %lanes, i64 64)
  %lock = call i64 @word(ptr %lanes, i64 80)
  %memory = call i64 @word(ptr %lanes, i64 88)
  %registers = call i64 @word(ptr %lanes, i64 104)
  %source = call i64 @word(ptr %lanes, i64 120)
  %state = call i64 @word(ptr %lanes, i64 136)
  %words = call i64 @word(ptr %lanes, i64 144)
  %weak = call i64 @word(ptr %lanes, i64 $LANES_WEAK_LIST)
  %any.1 = or i64 %arrays, %buffers
  %any.2 = or i64 %cells, %hidden
  %any.3 = or i64 %lock, %memory
  %any.4 = or i64 %registers, %source
  %any.5 = or i64 %state, %words
  %any.6 = or i64 %any.1, %any.2
  %any.7 = or i64 %any.3, %any.4
  %any.8 = or i64 %any.5, %weak
  %any.9 = or i64 %any.6, %any.7
  %any = or i64 %any.8, %any.9
  %untouched = icmp eq i64 %any, 0
  br i1 %untouched, label %memory.too, label %no
memory.too:
  %arena = call ptr @pointer(ptr %lanes, i64 24)
  %has.arena = icmp ne ptr %arena, null
  br i1 %has.arena, label %look.there, label %no
look.there:
  %its.own = call i1 @is_spare(ptr %arena)
  %exports = call i64 @word(ptr %arena, i64 48)
  %hidden.well = icmp eq i64 %exports, 0
  %good = and i1 %its.own, %hidden.well
  br i1 %good, label %search, label %no
search:
  %place = call ptr @among(ptr %spares, ptr @_Py_NoneStruct)
  %is.room = icmp ne ptr %place, null
  br i1 %is.room, label %put, label %no
put:
  ; else the collector of garbage, if the holder ends because of it, would go on to empty them
  call void @PyObject_GC_UnTrack(ptr %lanes)
  call void @put_pointer(ptr %lanes, i64 128, ptr null)
  store ptr %lanes, ptr %place
  call void @Py_DecRef(ptr @_Py_NoneStruct)
  call void @Py_DecRef(ptr %spares)
  ret i1 true
no:
  ret i1 false
}

; Lanes that were kept, and a reference to them; null if there are none.
define internal ptr @unstash(ptr %spares) {
  %is.list = icmp ne ptr %spares, @_Py_NoneStruct
  br i1 %is.list, label %search, label %no
search:
  %place = call ptr @among(ptr %spares, ptr null)
  %is.some = icmp ne ptr %place, null
  br i1 %is.some, label %take, label %no
take:
  %lanes = load ptr, ptr %place
  call void @Py_IncRef(ptr @_Py_NoneStruct)
  store ptr @_Py_NoneStruct, ptr %place
  call void @keep(ptr %spares)
  call void @put_pointer(ptr %lanes, i64 128, ptr %spares)
  call void @PyObject_GC_Track(ptr %lanes)
  ret ptr %lanes
no:
  ret ptr null
}

; Where in a list an object stands, or, without one, anything but None; null if nowhere.
define internal ptr @among(ptr %list, ptr %wanted) {
  %count = call i64 @word(ptr %list, i64 16)
  %items = call ptr @pointer(ptr %list, i64 24)
  %any = icmp eq ptr %wanted, null
  br label %head
head:
  %index = phi i64 [ 0, %0 ], [ %next, %again ]
  %more = icmp slt i64 %index, %count
  br i1 %more, label %each, label %nowhere
each:
  %next = add i64 %index, 1
  %at = getelementptr ptr, ptr %items, i64 %index
  %item = load ptr, ptr %at
  %is.wanted = icmp eq ptr %item, %wanted
  %is.some = icmp ne ptr %item, @_Py_NoneStruct
  %is.any = and i1 %any, %is.some
  %is.it = or i1 %is.wanted, %is.any
  br i1 %is.it, label %found, label %again
again:
  br label %head
found:
  ret ptr %at
nowhere:
  ret ptr null
}
