;;; Classes of messages.

(defmacro define-operators (name documentation)
  "(make-NAME &key SLOT ...) for a class of structure-class, and an inline accessor NAME-SLOT for each slot, which boxes no number."
  (flet ((keyword (slot)
           (intern (string slot) :keyword)))
    (loop for each in (sb-mop:class-direct-slots (find-class name))
          for slot = (sb-mop:slot-definition-name each)
          for value = (gensym "VALUE")
          for accessor = (named name "-" slot)
          collect `((,(keyword slot) ,value) ,(sb-mop:slot-definition-initform each)) into parameters
          append `((slot-value object ',slot) ,value) into values
          append `((declaim (inline ,accessor (setf ,accessor)))
                   (defun ,accessor (object)
                     (slot-value (the ,name object) ',slot))
                   (defun (setf ,accessor) (value object)
                     (setf (slot-value (the ,name object) ',slot) value)))
            into accessors
          finally (return
                    `(progn
                       (setf (documentation ',name 'type) ,documentation)
                       (defun ,(named "MAKE-" name) (&key ,@parameters)
                         (let ((object (copy-structure (load-time-value (allocate-instance (find-class ',name))))))
                           (declare (type ,name object))
                           (setf ,@values)
                           object))
                       ,@accessors)))))

;;; From rows to objects: what was there before is used again where it fits.

(defmacro define-numbers (type width)
  "(f64s old lane first count) is a vector of numbers of a lane, and (append-f64s lane used numbers) puts them behind others there."
  (let ((name (named type "S")) (append (named "APPEND-" type "S")))
    `(progn
       (defun ,name (old lane first count)
         (declare (type octets lane) (type (unsigned-byte 48) first count))
         (let ((numbers (if (and (typep old '(simple-array ,type (*))) (= (length old) count))
                            old
                            (make-array count :element-type ',type))))
           (sb-kernel:ub8-bash-copy lane (* ,width first) numbers 0 (* ,width count))
           numbers))
       (defun ,append (lane used numbers)
         (declare (type octets lane) (type (unsigned-byte 48) used) (type (simple-array ,type (*)) numbers))
         (let ((lane (with-rows lane used (length numbers) ,width)))
           (declare (type octets lane))
           (sb-kernel:ub8-bash-copy numbers 0 lane (* ,width used) (* ,width (length numbers)))
           (values lane (+ used (length numbers))))))))

(defun with-rows (lane used count stride)
  "A lane with room for more rows."
  (declare (type octets lane) (type fixnum used count stride))
  (if (> (* stride (+ used count)) (length lane))
      (with-room lane used count stride most-positive-fixnum)
      lane))

(define-numbers u16 2)
(define-numbers u32 4)
(define-numbers u64 8)
(define-numbers i16 2)
(define-numbers i32 4)
(define-numbers i64 8)
(define-numbers f32 4)
(define-numbers f64 8)

(defmacro define-bytes (type)
  "The same of bytes, which may lie in the message."
  (let ((name (named type "S")) (append (named "APPEND-" type "S")))
    `(progn
       (defun ,name (old lane first count data)
         (declare (type i64 first count))
         (with-bytes-of (octets start end) (lane first count data)
           (let ((numbers (if (and (typep old '(simple-array ,type (*))) (= (length old) (- end start)))
                              old
                              (make-array (- end start) :element-type ',type))))
             (declare (type (simple-array ,type (*)) numbers))
             (sb-kernel:ub8-bash-copy octets start numbers 0 (- end start))
             numbers)))
       (defun ,append (lane used numbers)
         (declare (type octets lane) (type fixnum used) (type (simple-array ,type (*)) numbers))
         (let ((lane (with-rows lane used (length numbers) 1)))
           (sb-kernel:ub8-bash-copy numbers 0 lane used (length numbers))
           (values lane (+ used (length numbers))))))))

(define-bytes u8)
(define-bytes i8)

(defmacro elements ((old first count) (before index) value)
  "A vector of VALUEs, one for each row of an array: BEFORE is the element that was at its place, INDEX the row."
  (let ((size (gensym "COUNT")) (start (gensym "FIRST")) (all (gensym "ELEMENTS")) (number (gensym "NUMBER")) (was (gensym "OLD")))
    `(let* ((,start ,first)
            (,size ,count)
            (,was ,old)
            (,all (if (and (simple-vector-p ,was) (= (length ,was) ,size)) ,was (make-array ,size :initial-element nil))))
       (declare (type fixnum ,start ,size) (type simple-vector ,all))
       (dotimes (,number ,size ,all)
         (let ((,before (svref ,all ,number)) (,index (the fixnum (+ ,start ,number))))
           (declare (ignorable ,before) (type fixnum ,index))
           (setf (svref ,all ,number) ,value))))))

(defmacro entries ((old first count) (index) key value)
  "A hash table of the rows of a map; the last of equal keys counts."
  (let ((size (gensym "COUNT")) (start (gensym "FIRST")) (table (gensym "TABLE")) (number (gensym "NUMBER")) (was (gensym "OLD")))
    `(let* ((,start ,first)
            (,size ,count)
            (,was ,old)
            (,table (if (hash-table-p ,was) (clrhash ,was) (make-hash-table :test 'equal))))
       (declare (type fixnum ,start ,size))
       (dotimes (,number ,size ,table)
         (let ((,index (the fixnum (+ ,start ,number))))
           (declare (type fixnum ,index))
           (setf (gethash ,key ,table) ,value))))))

;;; From objects to rows.

(defvar *where* '() "The way to a value that cannot be written, from the outside in.")

(defmacro reporting (where &body body)
  "Forms that write a part of an object: of an error in them *WHERE* tells it."
  `(handler-bind ((error (lambda (condition)
                           (declare (ignore condition))
                           (push ,where *where*))))
     ,@body))

(defmacro reporting-element (index &body body)
  "The same of an element of a vector, or of an entry of a hash table."
  (let ((own (gensym "INDEX")))
    `(let ((,own ,index))
       (reporting (format nil "[~S]" ,own) ,@body))))

(defun misfit (condition)
  "What a type error says, in a line."
  (let ((*print-pretty* nil) (*print-length* 8) (*print-level* 3))
    (format nil "~S is not of type ~S" (type-error-datum condition) (type-error-expected-type condition))))

(defun unfit (detail)
  (error 'encode-error :kind :range :path (format nil "~{~A~}" *where*) :detail detail))

(defun append-rows (lane used count stride)
  "More rows, filled with 0."
  (declare (type octets lane) (type fixnum used count stride))
  (let ((lane (with-rows lane used count stride)))
    (declare (type octets lane))
    (fill lane 0 :start (* stride used) :end (* stride (+ used count)))
    (values lane (+ used count))))

(defun append-bools (lane used bools)
  (declare (type octets lane) (type fixnum used) (type simple-vector bools))
  (let ((lane (with-rows lane used (length bools) 1)))
    (declare (type octets lane))
    (dotimes (number (length bools))
      (setf (aref lane (+ used number)) (if (svref bools number) 1 0)))
    (values lane (+ used (length bools)))))

(defun unwritable (char)
  (error 'encode-error :kind :range :path "" :detail (format nil "U+~4,'0X is no character" (char-code char))))

(defun append-text (lane used text)
  "The bytes of a string in UTF-8; U+DC80 to U+DCFF stand for bytes that are none of it."
  (declare (type octets lane) (type fixnum used) (type string text))
  (let ((lane (with-rows lane used (* 4 (length text)) 1)) (at used))
    (declare (type octets lane) (type fixnum at))
    (flet ((put (octet)
             (setf (aref lane at) octet)
             (incf at)))
      (declare (inline put))
      (loop for char across text
            for code = (char-code char)
            do (cond ((< code #x80) (put code))
                     ((< code #x800) (put (logior #xc0 (ash code -6))) (put (logior #x80 (logand code #x3f))))
                     ((<= #xdc80 code #xdcff) (put (- code #xdc00)))
                     ((<= #xd800 code #xdfff) (unwritable char))
                     ((< code #x10000)
                      (put (logior #xe0 (ash code -12)))
                      (put (logior #x80 (logand (ash code -6) #x3f)))
                      (put (logior #x80 (logand code #x3f))))
                     (t
                      (put (logior #xf0 (ash code -18)))
                      (put (logior #x80 (logand (ash code -12) #x3f)))
                      (put (logior #x80 (logand (ash code -6) #x3f)))
                      (put (logior #x80 (logand code #x3f)))))))
    (values lane at)))

(defun append-utf-16 (lane used text)
  (declare (type octets lane) (type fixnum used) (type string text))
  (let ((lane (with-rows lane used (* 2 (length text)) 2)) (at used))
    (declare (type octets lane) (type fixnum at))
    (flet ((put (unit)
             (setf (u16-at lane (* 2 at)) unit)
             (incf at)))
      (loop for code = nil
            for char across text
            do (setf code (char-code char))
               (cond ((< code #x10000) (put code))
                     (t
                      (put (+ #xd800 (ash (- code #x10000) -10)))
                      (put (+ #xdc00 (logand code #x3ff)))))))
    (values lane at)))

(defmacro put-span ((row at) (lane used) append &rest given)
  "Let APPEND put something behind what is in a lane, and note in a row where it lies there."
  (let ((start (gensym "START")))
    `(let ((,start ,used))
       (setf (values ,lane ,used) (,append ,lane ,start ,@given))
       (setf (i64-at ,row ,at) ,start
             (i64-at ,row (+ ,at 8)) (- ,used ,start)))))

(defmacro checked (value type)
  "A value that must have a type, as numbers in lists and unions of which no slot says so."
  (let ((found (gensym "VALUE")))
    `(let ((,found ,value))
       (check-type ,found ,type)
       ,found)))

(defmacro set-bit (octets at bit)
  `(setf (u64-at ,octets ,at) (logior (u64-at ,octets ,at) (ash 1 ,bit))))
