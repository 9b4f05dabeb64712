;;; What generated Lisp stands on: bytes as numbers, arithmetic of machines, texts, and conditions. It needs SBCL and nothing else.

#-(and sbcl little-endian 64-bit)
(error "this file is made for SBCL on machines of 64 bits that have the low byte of a number first")

(defpackage #:$package
  (:use #:common-lisp)
  (:export #:decode #:encode #:encode-into #:message-size #:codec #:make-codec #:*now* #:refused #:octets #:with-floats
           #:message-error #:decode-error #:encode-error #:message-error-kind #:message-error-path
           #:message-error-detail #:message-error-line #:message-error-offset))

(in-package #:$package)

(declaim (sb-ext:muffle-conditions sb-ext:compiler-note))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *proven* '(optimize (speed 1) (safety 0) (debug 0) (sb-ext:inhibit-warnings 3))
    "How functions are compiled whose every access is known to be safe: messages are checked by their own statements."))

;;; Types of the kernels.

(deftype u8 () '(unsigned-byte 8))
(deftype u16 () '(unsigned-byte 16))
(deftype u32 () '(unsigned-byte 32))
(deftype u64 () '(unsigned-byte 64))
(deftype i8 () '(signed-byte 8))
(deftype i16 () '(signed-byte 16))
(deftype i32 () '(signed-byte 32))
(deftype i64 () '(signed-byte 64))
(deftype f32 () 'single-float)
(deftype f64 () 'double-float)
(deftype octets () '(simple-array (unsigned-byte 8) (*)))

;;; Conditions.

(define-condition refused (error) ()
  (:documentation "Signalled by a function that the mapping declares, which does not accept its arguments."))

(define-condition message-error (error)
  ((kind :initarg :kind :reader message-error-kind :documentation "A keyword, as :truncated.")
   (path :initarg :path :reader message-error-path :documentation "The field, as .joints[3].name.")
   (detail :initarg :detail :reader message-error-detail :documentation "One sentence.")
   (line :initarg :line :initform "" :reader message-error-line :documentation "The rule of the mapping, file:line:column.")
   (offset :initarg :offset :initform nil :reader message-error-offset :documentation "The byte of the message, if one was read."))
  (:report (lambda (condition stream)
             (with-slots (kind path detail line offset) condition
               (format stream "~(~A~)~@[ at ~A~]~@[, byte ~D~]: ~A~@[ (~A)~]"
                       kind (and (plusp (length path)) path) offset detail (and (plusp (length line)) line)))))
  (:documentation "What is wrong with a message."))

(define-condition decode-error (message-error) ()
  (:documentation "A message that cannot be read."))

(define-condition encode-error (message-error) ()
  (:documentation "An object that cannot be written."))

;;; What can be wrong with a message, and where. A {} in a path stands for an index; parts tell fields apart that are checked at once.

(defstruct (site (:constructor site (kind path detail line &key parts scratch)) (:copier nil) (:predicate nil))
  kind path detail line parts scratch)

(defstruct (failure (:copier nil) (:predicate nil))
  "How an attempt to read or write ended."
  (site 0 :type fixnum)
  (at 0 :type i64)
  (path "" :type string)
  (index-1 0 :type i64)
  (index-2 0 :type i64)
  (index-3 0 :type i64)
  (index-4 0 :type i64)
  (index-5 0 :type i64)
  (index-6 0 :type i64))

(defun no-octets ()
  (make-array 0 :element-type 'u8))

(defstruct (codec-state (:copier nil) (:predicate nil))
  "What all codecs have: the last failure and the farthest one, what the mapping asks of its host, and results of routines."
  (failure (make-failure) :type failure)
  (farthest (make-failure) :type failure)
  (most 0 :type i64)
  (now 0 :type i64)
  (number 0 :type i64)
  (u64-result-1 0 :type u64)
  (u64-result-2 0 :type u64)
  (u64-result-3 0 :type u64)
  (u64-result-4 0 :type u64)
  (i64-result-1 0 :type i64)
  (i64-result-2 0 :type i64)
  (i64-result-3 0 :type i64)
  (i64-result-4 0 :type i64)
  (i64-result-5 0 :type i64)
  (i64-result-6 0 :type i64))

(defun fail (codec site at &optional (index-1 0) (index-2 0) (index-3 0) (index-4 0) (index-5 0) (index-6 0))
  "Note a failure; gives what a kernel returns then."
  (let ((failure (codec-state-failure codec)))
    (setf (failure-site failure) site
          (failure-at failure) at
          (failure-index-1 failure) index-1
          (failure-index-2 failure) index-2
          (failure-index-3 failure) index-3
          (failure-index-4 failure) index-4
          (failure-index-5 failure) index-5
          (failure-index-6 failure) index-6)
    (- -1 site)))

(defun fail-there (codec site &rest indices)
  "The same where a routine has noted the place."
  (apply #'fail codec site (failure-at (codec-state-failure codec)) indices))

(defun fail-here (codec site at)
  "Note the place of a failure in a routine; gives the number of its own site."
  (setf (failure-at (codec-state-failure codec)) at)
  site)

(defun full (codec path)
  "A message asks for more rows than its size allows."
  (setf (failure-path (codec-state-failure codec)) path)
  (fail codec 0 0))

(defun copy-failure (from to)
  (setf (failure-site to) (failure-site from)
        (failure-at to) (failure-at from)
        (failure-path to) (failure-path from)
        (failure-index-1 to) (failure-index-1 from)
        (failure-index-2 to) (failure-index-2 from)
        (failure-index-3 to) (failure-index-3 from)
        (failure-index-4 to) (failure-index-4 from)
        (failure-index-5 to) (failure-index-5 from)
        (failure-index-6 to) (failure-index-6 from)))

(defun attempts (codec kernel data end how-many)
  "Run the attempts of a kernel until one succeeds; gives where the message ends, or nil, and the farthest failure is noted."
  (declare (type function kernel))
  (let ((failure (codec-state-failure codec)) (farthest (codec-state-farthest codec)))
    (loop for number from 1 to how-many
          for position of-type fixnum = (funcall kernel codec data end number)
          do (when (>= position 0)
               (return position))
             (when (or (= number 1) (= (failure-site failure) 0) (> (failure-at failure) (failure-at farthest)))
               (copy-failure failure farthest))
             (when (= (failure-site failure) 0)
               (return nil)))))

(defun with-indices (path indices)
  "A path with its indices in place."
  (with-output-to-string (text)
    (loop with start = 0
          for hole = (search "{}" path :start2 start)
          do (write-string path text :start start :end hole)
             (unless hole
               (return))
             (format text "~D" (if indices (pop indices) 0))
             (setf start (+ hole 2)))))

(defun holes (path)
  (loop for start = (search "{}" path) then (search "{}" path :start2 (+ start 2)) while start count t))

(defun lacking (parts available)
  "The first part of which bytes are missing, and the number of its element."
  (loop for part in parts
        for (offset size step) = part
        for spare = (- available offset size)
        do (when (or (plusp step) (minusp spare))
             (return (values part (if (and (plusp step) (>= spare 0)) (1+ (floor spare step)) 0))))))

(defun signal-failure (codec sites end)
  "Signal what the farthest failure was; END is that of the message which was read, or nil."
  (let* ((failure (codec-state-farthest codec))
         (site (svref sites (failure-site failure)))
         (path (if (= (failure-site failure) 0) (failure-path failure) (site-path site)))
         (at (failure-at failure))
         (indices (list (failure-index-1 failure) (failure-index-2 failure) (failure-index-3 failure)
                        (failure-index-4 failure) (failure-index-5 failure) (failure-index-6 failure)))
         (detail (if (site-scratch site) (detail-in codec site indices) (site-detail site))))
    (multiple-value-bind (part element) (lacking (site-parts site) (if end (- end at) 0))
      (when part
        (destructuring-bind (offset size step inner) part
          (declare (ignore size))
          (setf path inner
                at (+ at offset (* element step)))
          (when (and (plusp step) (plusp (holes inner)))
            (setf (nth (1- (holes inner)) indices) element)))))
    (error (if end 'decode-error 'encode-error)
           :kind (site-kind site) :path (with-indices path indices) :detail detail :line (site-line site)
           :offset (and end at))))

(defun detail-in (codec site indices)
  "What the mapping says: the last two indices tell where, in a lane of the codec."
  (let ((count (holes (site-path site))))
    (text-of "" (funcall (site-scratch site) codec) (nth count indices) (nth (1+ count) indices) (no-octets))))

;;; Numbers in bytes: (u32-at octets 4) is setf-able, and (u32-be-at octets 4) has its high byte first.

(defmacro define-access (name type reference)
  `(progn
     (declaim (inline ,name (setf ,name)))
     (defun ,name (octets at)
       (declare ,*proven* (type octets octets) (type fixnum at))
       (sb-sys:with-pinned-objects (octets)
         (,reference (sb-sys:vector-sap octets) at)))
     (defun (setf ,name) (value octets at)
       (declare ,*proven* (type octets octets) (type fixnum at) (type ,type value))
       (sb-sys:with-pinned-objects (octets)
         (setf (,reference (sb-sys:vector-sap octets) at) value)))))

(define-access u8-at u8 sb-sys:sap-ref-8)
(define-access u16-at u16 sb-sys:sap-ref-16)
(define-access u32-at u32 sb-sys:sap-ref-32)
(define-access u64-at u64 sb-sys:sap-ref-64)
(define-access i8-at i8 sb-sys:signed-sap-ref-8)
(define-access i16-at i16 sb-sys:signed-sap-ref-16)
(define-access i32-at i32 sb-sys:signed-sap-ref-32)
(define-access i64-at i64 sb-sys:signed-sap-ref-64)
(define-access f32-at f32 sb-sys:sap-ref-single)
(define-access f64-at f64 sb-sys:sap-ref-double)

(declaim (inline bool-at (setf bool-at)))
(defun bool-at (octets at)
  (declare #.*proven* (type octets octets) (type fixnum at))
  (/= 0 (aref octets at)))
(defun (setf bool-at) (value octets at)
  (declare #.*proven* (type octets octets) (type fixnum at))
  (setf (aref octets at) (if value 1 0)))

;;; Arithmetic of one type, whose results are known to fit: (i64+ a b), (u8* a b) and so on.

(defmacro define-arithmetic (type bits)
  (flet ((named (operator) (intern (format nil "~A~A" type operator))))
    `(progn
       ,@(loop for operator in '(+ - *)
               collect `(defmacro ,(named operator) (left right)
                          `(the ,',type (,',operator (the ,',type ,left) (the ,',type ,right)))))
       (defmacro ,(named '/) (left right)
         `(the ,',type (values (truncate (the ,',type ,left) (the ,',type ,right)))))
       (defmacro ,(named '-rem) (left right)
         `(the ,',type (rem (the ,',type ,left) (the ,',type ,right))))
       (defmacro ,(named '-neg) (value)
         `(the ,',type (- (the ,',type ,value))))
       (defmacro ,(named '-abs) (value)
         `(the ,',type (abs (the ,',type ,value))))
       (defmacro ,(named '>>) (value by)
         `(the ,',type (ash (the ,',type ,value) (- (the (integer 0 ,',(1- bits)) ,by)))))
       (defmacro ,(named '<<) (value by)
         `(,',(intern (format nil "WRAP-~A" type))
           (ash (the u64 (wrap-u64 (the ,',type ,value))) (the (integer 0 ,',(1- bits)) ,by)))))))

(define-arithmetic u8 8)
(define-arithmetic u16 16)
(define-arithmetic u32 32)
(define-arithmetic u64 64)
(define-arithmetic i8 8)
(define-arithmetic i16 16)
(define-arithmetic i32 32)
(define-arithmetic i64 64)

;;; The low bits of an integer.

(defmacro wrap-u8 (value) `(logand ,value #xff))
(defmacro wrap-u16 (value) `(logand ,value #xffff))
(defmacro wrap-u32 (value) `(logand ,value #xffffffff))
(defmacro wrap-u64 (value) `(logand ,value #xffffffffffffffff))
(defmacro wrap-i8 (value) `(signed-low-bits i8 8 ,value))
(defmacro wrap-i16 (value) `(signed-low-bits i16 16 ,value))
(defmacro wrap-i32 (value) `(signed-low-bits i32 32 ,value))
(defmacro wrap-i64 (value) `(signed-low-bits i64 64 ,value))

(defmacro signed-low-bits (type bits value)
  `(the ,type (sb-c::mask-signed-field ,bits (the u64 (wrap-u64 ,value)))))

(declaim (inline fits+ fits- swapped-16 swapped-32 swapped-64))

(defun fits+ (left right)
  (declare #.*proven* (type i64 left right))
  (let ((sum (wrap-i64 (+ (wrap-u64 left) (wrap-u64 right)))))
    (>= (logand (logxor left sum) (logxor right sum)) 0)))

(defun fits- (left right)
  (declare #.*proven* (type i64 left right))
  (let ((difference (wrap-i64 (- (wrap-u64 left) (wrap-u64 right)))))
    (>= (logand (logxor left right) (logxor left difference)) 0)))

(defun fits* (left right)
  (declare (type i64 left right))
  (or (and (< -2147483648 left 2147483648) (< -2147483648 right 2147483648))
      (typep (* left right) 'i64)))

;;; Numbers whose high byte comes first.

(defun swapped-16 (value)
  (declare #.*proven* (type u16 value))
  (logior (ash (logand value #xff) 8) (ash value -8)))

(defun swapped-32 (value)
  (declare #.*proven* (type u32 value))
  (logior (ash (swapped-16 (logand value #xffff)) 16) (swapped-16 (ash value -16))))

(defun swapped-64 (value)
  (declare #.*proven* (type u64 value))
  (logior (the u64 (ash (swapped-32 (logand value #xffffffff)) 32)) (swapped-32 (ash value -32))))

;;; Floats. What becomes NaN, infinite or 0 does so silently within WITH-FLOATS.

(defmacro with-floats (&body body)
  "Run BODY without traps of floats. Around a loop over messages it saves most of what it costs to change the mode of the processor."
  `(let ((modes (sb-vm:floating-point-modes)))
     (flet ((run ()
              ,@body))
       (declare (inline run))
       (if (= 0 (ldb sb-vm:float-traps-byte modes))
           (run)
           (unwind-protect
                (progn
                  (setf (sb-vm:floating-point-modes) (dpb 0 sb-vm:float-traps-byte modes))
                  (run))
             (setf (sb-vm:floating-point-modes) modes))))))

(declaim (inline bits-of-f64 bits-of-f32 f64-of-bits f32-of-bits f64-of-f32 f32-of-f64 f64-of-i64 f32-of-i64 f64-of-u64 f32-of-u64
                 f<= f64-min f64-max f32-min f32-max f64-sqrt f32-sqrt f64-rem f32-rem))

(defun bits-of-f64 (value)
  (declare #.*proven* (type f64 value))
  (the u64 (wrap-u64 (the i64 (sb-kernel:double-float-bits value)))))

(defun bits-of-f32 (value)
  (declare #.*proven* (type f32 value))
  (the u32 (wrap-u32 (the i32 (sb-kernel:single-float-bits value)))))

(defun f64-of-bits (bits)
  (declare #.*proven* (type u64 bits))
  (sb-kernel:make-double-float (wrap-i32 (ash bits -32)) (logand bits #xffffffff)))

(defun f32-of-bits (bits)
  (declare #.*proven* (type u32 bits))
  (sb-kernel:make-single-float (wrap-i32 bits)))

(defun f64-of-f32 (value)
  (declare #.*proven* (type f32 value))
  (coerce value 'double-float))

(defun f32-of-f64 (value)
  (declare #.*proven* (type f64 value))
  (coerce value 'single-float))

(defun f64-of-i64 (value)
  (declare #.*proven* (type i64 value))
  (coerce value 'double-float))

(defun f32-of-i64 (value)
  (declare #.*proven* (type i64 value))
  (coerce value 'single-float))

(defun f64-of-u64 (value)
  "Of large numbers half, where the lowest bit stays as what was rounded off."
  (declare #.*proven* (type u64 value))
  (if (< value #x8000000000000000)
      (f64-of-i64 (the i64 value))
      (* 2d0 (f64-of-i64 (the i64 (logior (ash value -1) (logand value 1)))))))

(defun f32-of-u64 (value)
  (declare #.*proven* (type u64 value))
  (if (< value #x8000000000000000)
      (f32-of-i64 (the i64 value))
      (* 2f0 (f32-of-i64 (the i64 (logior (ash value -1) (logand value 1)))))))

(defun f<= (left right)
  (declare #.*proven*)
  (or (< left right) (= left right)))

(defun f64-min (left right)
  (declare #.*proven* (type f64 left right))
  (if (< left right) left right))

(defun f64-max (left right)
  (declare #.*proven* (type f64 left right))
  (if (> left right) left right))

(defun f32-min (left right)
  (declare #.*proven* (type f32 left right))
  (if (< left right) left right))

(defun f32-max (left right)
  (declare #.*proven* (type f32 left right))
  (if (> left right) left right))

(defun f64-sqrt (value)
  (declare #.*proven* (type f64 value))
  (sb-kernel:%sqrt value))

(defun f64-rem (left right)
  (declare #.*proven* (type f64 left right))
  (sb-alien:alien-funcall (sb-alien:extern-alien "fmod" (function sb-alien:double sb-alien:double sb-alien:double)) left right))

(defmacro define-angular (name function &rest parameters)
  `(progn
     (declaim (inline ,name))
     (defun ,name ,parameters
       (declare ,*proven* (type f64 ,@parameters))
       (,function ,@parameters))))

(define-angular f64-sin sb-kernel::%sin value)
(define-angular f64-cos sb-kernel::%cos value)
(define-angular f64-tan sb-kernel::%tan value)
(define-angular f64-asin sb-kernel::%asin value)
(define-angular f64-acos sb-kernel::%acos value)
(define-angular f64-atan sb-kernel::%atan value)
(define-angular f64-atan2 sb-kernel::%atan2 value other)

(defmacro define-rounding (double single adjusted)
  "Rounding to an integer: ADJUSTED is the result, where ROUNDED is the nearest one, halves to even. The sign stays, of zero too."
  `(progn
     (declaim (inline ,double ,single))
     (defun ,double (value)
       (declare ,*proven* (type f64 value))
       (if (< (abs value) 4503599627370496d0)
           (let ((rounded (float-sign value (- (+ (abs value) 4503599627370496d0) 4503599627370496d0))))
             (declare (type f64 rounded))
             (float-sign value ,adjusted))
           value))
     (defun ,single (value)
       (declare ,*proven* (type f32 value))
       (f32-of-f64 (,double (f64-of-f32 value))))))

(define-rounding f64-rint f32-rint rounded)
(define-rounding f64-floor f32-floor (if (> rounded value) (- rounded 1d0) rounded))
(define-rounding f64-ceil f32-ceil (if (< rounded value) (+ rounded 1d0) rounded))
(define-rounding f64-trunc f32-trunc (if (> (abs rounded) (abs value)) (- (abs rounded) 1d0) rounded))

(defun f32-sqrt (value)
  (declare #.*proven* (type f32 value))
  (f32-of-f64 (f64-sqrt (f64-of-f32 value))))

(defun f32-rem (left right)
  (declare #.*proven* (type f32 left right))
  (f32-of-f64 (f64-rem (f64-of-f32 left) (f64-of-f32 right))))

;;; Floats as integers: truncated toward zero; what does not fit becomes the nearest that does, and no number 0.

(declaim (inline i64-of-f64 u64-of-f64 i64-of-f32 u64-of-f32))

(defun i64-of-f64 (value)
  (declare #.*proven* (type f64 value))
  (cond ((/= value value) 0)
        ((>= value 9223372036854775808d0) 9223372036854775807)
        ((<= value -9223372036854775808d0) -9223372036854775808)
        (t (the i64 (sb-kernel:%unary-truncate/double-float value)))))

(defun u64-of-f64 (value)
  (declare #.*proven* (type f64 value))
  (cond ((< value 9223372036854775808d0) (the u64 (max 0 (i64-of-f64 value))))
        ((>= value 18446744073709551616d0) 18446744073709551615)
        ((/= value value) 0)
        (t (logior #x8000000000000000 (the u64 (i64-of-f64 (- value 9223372036854775808d0)))))))

(defun i64-of-f32 (value)
  (declare #.*proven* (type f32 value))
  (i64-of-f64 (f64-of-f32 value)))

(defun u64-of-f32 (value)
  (declare #.*proven* (type f32 value))
  (u64-of-f64 (f64-of-f32 value)))

(defmacro define-saturating (double single least greatest)
  `(progn
     (declaim (inline ,double ,single))
     (defun ,double (value)
       (declare ,*proven* (type f64 value))
       (max ,least (min ,greatest (i64-of-f64 value))))
     (defun ,single (value)
       (declare ,*proven* (type f32 value))
       (max ,least (min ,greatest (i64-of-f32 value))))))

(define-saturating u8-of-f64 u8-of-f32 0 255)
(define-saturating u16-of-f64 u16-of-f32 0 65535)
(define-saturating u32-of-f64 u32-of-f32 0 4294967295)
(define-saturating i8-of-f64 i8-of-f32 -128 127)
(define-saturating i16-of-f64 i16-of-f32 -32768 32767)
(define-saturating i32-of-f64 i32-of-f32 -2147483648 2147483647)

;;; Numbers in bytes whose high byte comes first.

(defmacro define-swapped (name type swap access into out-of)
  "NAME is ACCESS with the bytes turned around by SWAP; INTO and OUT-OF make the number of its bits, and bits of the number."
  `(progn
     (declaim (inline ,name (setf ,name)))
     (defun ,name (octets at)
       (declare ,*proven* (type octets octets) (type fixnum at))
       (,into (,swap (,access octets at))))
     (defun (setf ,name) (value octets at)
       (declare ,*proven* (type octets octets) (type fixnum at) (type ,type value))
       (setf (,access octets at) (,swap (,out-of value)))
       value)))

(define-swapped u16-be-at u16 swapped-16 u16-at progn progn)
(define-swapped u32-be-at u32 swapped-32 u32-at progn progn)
(define-swapped u64-be-at u64 swapped-64 u64-at progn progn)
(define-swapped i16-be-at i16 swapped-16 u16-at wrap-i16 wrap-u16)
(define-swapped i32-be-at i32 swapped-32 u32-at wrap-i32 wrap-u32)
(define-swapped i64-be-at i64 swapped-64 u64-at wrap-i64 wrap-u64)
(define-swapped f32-be-at f32 swapped-32 u32-at f32-of-bits bits-of-f32)
(define-swapped f64-be-at f64 swapped-64 u64-at f64-of-bits bits-of-f64)

;;; Statements of kernels.

(defmacro for ((variable count) &body body)
  "Run BODY with VARIABLE from 0 up to COUNT."
  (let ((end (gensym "END")))
    `(do ((,variable 0 (the i64 (1+ ,variable)))
          (,end ,count))
         ((>= ,variable ,end))
       (declare (type i64 ,variable ,end))
       ,@body)))

(defmacro while (condition &body body)
  `(loop (unless ,condition (return)) ,@body))

(defmacro row (stride index &optional (offset 0))
  "The byte of a lane where a row begins, or a field of it."
  `(the fixnum (+ (the fixnum (* ,stride (the fixnum ,index))) ,offset)))

(declaim (inline lacks copy-octets fill-octets))

(defun lacks (at size end)
  "Whether some of SIZE bytes from AT are missing."
  (declare #.*proven* (type i64 at size end))
  (or (< at 0) (< size 0) (> at end) (> size (the i64 (- end at)))))

(defun copy-octets (to first from begin size)
  (declare #.*proven* (type octets to from) (type fixnum first begin size))
  (replace to from :start1 first :start2 begin :end2 (the fixnum (+ begin size))))

(defun fill-octets (octets start size octet)
  (declare #.*proven* (type octets octets) (type fixnum start size))
  (fill octets octet :start start :end (the fixnum (+ start size))))

(defun with-room (octets used missing stride most)
  "Octets with room for more rows, at least twice as many; nil where that were more than MOST rows."
  (declare (type octets octets) (type i64 used missing stride most))
  (let ((wanted (+ used missing)))
    (unless (> wanted most)
      (let ((more (make-array (* stride (max wanted (min most (* 2 (floor (length octets) stride))))) :element-type 'u8)))
        (replace more octets)))))

(defmacro reserve ((rows place stride) used count codec full)
  "Room for COUNT more rows in ROWS, which PLACE keeps for the next message; or FULL."
  (let ((missing (gensym "MISSING")) (more (gensym "MORE")))
    `(let ((,missing ,count))
       (declare (type i64 ,missing))
       (when (> ,missing (the i64 (- (truncate (length ,rows) ,stride) ,used)))
         (let ((,more (with-room ,rows ,used ,missing ,stride (codec-state-most ,codec))))
           (if ,more
               (setf ,rows ,more ,place ,more)
               ,full))))))

(defmacro call-function ((name type) refused &rest arguments)
  "What a function that the mapping declares gives, which must have a type."
  `(handler-case
       (let ((found (funcall ',name ,@arguments)))
         (check-type found ,type)
         found)
     (refused () ,refused)))

;;; Texts.

(declaim (inline follows))

(defun follows (octets at end &optional (least #x80) (greatest #xbf))
  "Whether a byte of a character that began before is there."
  (declare #.*proven* (type octets octets) (type fixnum at end))
  (and (< at end) (<= least (aref octets at) greatest)))

(defun character-size (octets at end)
  "How many bytes the character at a place takes, 0 where there is none (Unicode 15, table 3-7)."
  (declare #.*proven* (type octets octets) (type fixnum at end))
  (let ((lead (aref octets at)))
    (cond ((< lead #x80) 1)
          ((<= #xc2 lead #xdf) (if (follows octets (1+ at) end) 2 0))
          ((<= #xe0 lead #xef)
           (if (and (follows octets (1+ at) end (if (= lead #xe0) #xa0 #x80) (if (= lead #xed) #x9f #xbf))
                    (follows octets (+ at 2) end))
               3
               0))
          ((<= #xf0 lead #xf4)
           (if (and (follows octets (1+ at) end (if (= lead #xf0) #x90 #x80) (if (= lead #xf4) #x8f #xbf))
                    (follows octets (+ at 2) end)
                    (follows octets (+ at 3) end))
               4
               0))
          (t 0))))

(defun text-p (octets start size)
  "Whether bytes are UTF-8."
  (declare #.*proven* (type octets octets) (type fixnum start size))
  (let ((at start) (end (+ start size)))
    (declare (type fixnum at end))
    (loop
      (loop while (and (<= (+ at 8) end) (= 0 (logand (u64-at octets at) #x8080808080808080)))
            do (incf at 8))
      (when (>= at end)
        (return t))
      (let ((step (character-size octets at end)))
        (declare (type fixnum step))
        (when (= step 0)
          (return nil))
        (incf at step)))))

(defun character-at (octets at end)
  "The character at a place and how many bytes it takes; a byte of none becomes one of U+DC80 to U+DCFF."
  (declare #.*proven* (type octets octets) (type fixnum at end))
  (let ((lead (aref octets at)) (size (character-size octets at end)))
    (declare (type fixnum size))
    (flet ((low-bits (number)
             (logand #x3f (aref octets (+ at number)))))
      (declare (inline low-bits))
      (values
       (code-char
        (ecase size
          (0 (+ #xdc00 lead))
          (1 lead)
          (2 (logior (ash (logand lead #x1f) 6) (low-bits 1)))
          (3 (logior (ash (logand lead #x0f) 12) (ash (low-bits 1) 6) (low-bits 2)))
          (4 (logior (ash (logand lead #x07) 18) (ash (low-bits 1) 12) (ash (low-bits 2) 6) (low-bits 3)))))
       (max size 1)))))

(defmacro with-bytes-of ((octets start end) (lane first count data) &body body)
  "Bytes that a decoder has left in a lane, or in the message: then their count is negative."
  `(let* ((in-lane (>= ,count 0))
          (,octets (if in-lane ,lane ,data))
          (,start ,first)
          (,end (if in-lane (+ ,first ,count) (- ,first 1 ,count))))
     (declare (type octets ,octets) (type fixnum ,start ,end))
     ,@body))

(defun same-text-p (old octets start end)
  "Whether a string is what the bytes say."
  (declare #.*proven* (type octets octets) (type fixnum start end))
  (and (typep old '(simple-array character (*)))
       (let ((at start))
         (declare (type fixnum at))
         (and (loop for char across old
                    always (and (< at end)
                                (multiple-value-bind (found step)
                                    (if (< (aref octets at) #x80) (values (code-char (aref octets at)) 1) (character-at octets at end))
                                  (declare (type fixnum step))
                                  (incf at step)
                                  (eq char found))))
              (= at end)))))

(defun text-of (old lane first count data)
  "The string of some bytes; the one that was there where it is the same."
  (declare (type i64 first count))
  (with-bytes-of (octets start end) (lane first count data)
    (if (same-text-p old octets start end)
        old
        (let ((size (loop with at of-type fixnum = start
                          while (< at end)
                          do (incf at (max 1 (the fixnum (character-size octets at end))))
                          count t)))
          (let ((text (make-string size)) (at start))
            (declare (type fixnum at))
            (dotimes (number size text)
              (multiple-value-bind (char step) (character-at octets at end)
                (setf (schar text number) char)
                (incf at (the fixnum step)))))))))

(defun utf-16-of (old lane first count)
  "The string of some code units; a surrogate without another stays one."
  (declare (type octets lane) (type i64 first count) (ignore old))
  (let ((end (+ first count)))
    (flet ((unit (number)
             (u16-at lane (* 2 number))))
      (with-output-to-string (text)
        (loop with at of-type fixnum = first
              while (< at end)
              do (let ((high (unit at)))
                   (cond ((and (<= #xd800 high #xdbff) (< (1+ at) end) (<= #xdc00 (unit (1+ at)) #xdfff))
                          (write-char (code-char (+ #x10000 (ash (- high #xd800) 10) (- (unit (1+ at)) #xdc00))) text)
                          (incf at 2))
                         (t
                          (write-char (code-char high) text)
                          (incf at)))))))))

(defun text (&rest parts)
  "A string of strings and of codes of characters."
  (format nil "~{~A~}" (mapcar (lambda (part) (if (integerp part) (code-char part) part)) parts)))

;;; From rows to objects: what was there before is used again where it fits.

(defmacro define-numbers (type)
  "(f64s old lane first count) is a vector of numbers of a lane, and (append-f64s lane used numbers) puts them behind others there."
  (let ((name (intern (format nil "~AS" type)))
        (append (intern (format nil "APPEND-~AS" type)))
        (access (intern (format nil "~A-AT" type)))
        (width (if (member type '(f32 f64)) (if (eq type 'f32) 4 8) (parse-integer (symbol-name type) :start 1))))
    (when (> width 8)
      (setf width (floor width 8)))
    `(progn
       (defun ,name (old lane first count)
         (declare (type octets lane) (type fixnum first count))
         (let ((numbers (if (and (typep old '(simple-array ,type (*))) (= (length old) count))
                            old
                            (make-array count :element-type ',type))))
           (declare (type (simple-array ,type (*)) numbers))
           (dotimes (number count numbers)
             (setf (aref numbers number) (,access lane (* ,width (the fixnum (+ first number))))))))
       (defun ,append (lane used numbers)
         (declare (type octets lane) (type fixnum used) (type (simple-array ,type (*)) numbers))
         (let ((lane (with-rows lane used (length numbers) ,width)))
           (declare (type octets lane))
           (dotimes (number (length numbers))
             (setf (,access lane (* ,width (the fixnum (+ used number)))) (aref numbers number)))
           (values lane (+ used (length numbers))))))))

(defun with-rows (lane used count stride)
  "A lane with room for more rows."
  (declare (type octets lane) (type fixnum used count stride))
  (if (> (* stride (+ used count)) (length lane))
      (with-room lane used count stride most-positive-fixnum)
      lane))

(define-numbers u16)
(define-numbers u32)
(define-numbers u64)
(define-numbers i16)
(define-numbers i32)
(define-numbers i64)
(define-numbers f32)
(define-numbers f64)

(defmacro define-bytes (type)
  "The same of bytes, which may lie in the message."
  (let ((name (intern (format nil "~AS" type))) (append (intern (format nil "APPEND-~AS" type))))
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

;;; Decimal numbers in texts.

(defun rounded-ratio (value places)
  "VALUE times ten to the power of PLACES as an integer, halves to even."
  (values (round (* (rational value) (expt 10 places)))))

(defun finite-p (value)
  (typecase value
    (double-float (< (logand (ash (bits-of-f64 value) -52) #x7ff) #x7ff))
    (single-float (< (logand (ash (bits-of-f32 value) -23) #xff) #xff))))

(defun fixed-digits (value places)
  "The digits of a number rounded to so many decimals, of which the low 64 bits count; 0 for what is not finite."
  (if (finite-p value) (wrap-u64 (rounded-ratio (abs value) places)) 0))

(defun decimal-exponent (value)
  "The power of ten of the first digit of a positive rational."
  (let ((exponent (floor (* (- (integer-length (numerator value)) (integer-length (denominator value))) 0.30103d0))))
    (loop while (>= value (expt 10 (1+ exponent))) do (incf exponent))
    (loop while (< value (expt 10 exponent)) do (decf exponent))
    exponent))

(defun significant (value count)
  "The first COUNT digits of a positive rational, rounded half to even, and the power of ten by which they are it."
  (let* ((power (- (decimal-exponent value) (1- count))) (digits (round (/ value (expt 10 power)))))
    (if (= digits (expt 10 count))
        (values (expt 10 (1- count)) (1+ power))
        (values digits power))))

(defun reads-back-p (digits power value)
  (let ((read (nearest-f64 (* digits (expt 10 power)))))
    (= value (if (typep value 'single-float) (f32-of-f64 read) read))))

(defun shortest (value)
  "The fewest digits that read back as the number, and the power of ten by which they are it; 0 for what is not finite.

Of a normal number they are not fewer than those that any float keeps: 15, or 6 of singles. Above a power of two the nearest digits
may not be among those that read back."
  (if (and (finite-p value) (/= value 0))
      (let* ((double (typep value 'double-float))
             (size (abs value))
             (normal (>= size (if double 2.2250738585072014d-308 1.17549435f-38)))
             (first (cond ((not normal) 1) (double 15) (t 6)))
             (last (if double 17 9))
             (is-power (= 1 (logcount (integer-decode-float size)))))
        (loop for count from first
              do (multiple-value-bind (digits power) (significant (rational size) count)
                   (loop for found from digits to (if is-power (1+ digits) digits)
                         do (when (or (= count last) (reads-back-p found power size))
                              (return-from shortest (values found power)))))))
      (values 0 0)))

(defun shortest-digits (value)
  (values (shortest value)))

(defun shortest-scale (value)
  (nth-value 1 (shortest value)))

(defun nearest-f64 (value)
  "The float that is nearest to a rational, not negative, number; halves to even."
  (if (= value 0)
      0d0
      (let* ((exponent (- (integer-length (numerator value)) (integer-length (denominator value))))
             (exponent (if (< value (expt 2 exponent)) (1- exponent) exponent))
             (unit (max (- exponent 52) -1074))
             (bits (round (/ value (expt 2 unit))))
             (biased (+ unit 1074)))
        (cond ((> exponent 1023) sb-ext:double-float-positive-infinity)
              (t (let ((sum (+ (ash biased 52) bits)))
                   ;; The hidden bit of a normal number adds 1 to the exponent, as a carry does.
                   (f64-of-bits (min sum #x7ff0000000000000))))))))

(defun nearest (octets start size exponent)
  "The float nearest to the integer that the digits among some bytes spell, times a power of ten. No tie needs more than 800 digits."
  (let ((digits (loop for at from start below (+ start size)
                      for octet = (aref octets at)
                      when (<= 48 octet 57)
                        collect (code-char octet))))
    (let* ((significant (coerce (member #\0 digits :test-not #'eql) 'string))
           (kept (subseq significant 0 (min 800 (length significant))))
           (more (find #\0 significant :start (length kept) :test-not #'eql))
           (text (if more (concatenate 'string kept "1") kept))
           (power (+ (length significant) exponent)))
      (cond ((or (string= text "") (< power -400)) 0d0)
            ((> power 400) sb-ext:double-float-positive-infinity)
            (t (nearest-f64 (* (parse-integer text) (expt 10 (- power (length text))))))))))

;;; The host of a mapping.

(defvar *now*
  (lambda ()
    (multiple-value-bind (seconds microseconds) (sb-ext:get-time-of-day)
      (* 1000 (+ microseconds (* 1000000 seconds)))))
  "The function that tells what now() is in the mapping: ns since 1970.")

(defstruct (counter (:copier nil) (:predicate nil))
  (next 0 :type sb-ext:word))

(defvar *counter* (make-counter)
  "How many messages were read and written, which counter() tells in the mapping.")

(defun tell (codec)
  "Let a codec know what the mapping asks of its host."
  (setf (codec-state-now codec) (funcall *now*)
        (codec-state-number codec) (sb-ext:atomic-incf (counter-next *counter*))))
