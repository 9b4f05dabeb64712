;;; What generated Lisp stands on: bytes as numbers, arithmetic of machines, texts, and conditions. It needs SBCL and nothing else.

#-(and sbcl little-endian 64-bit)
(error "this file is made for SBCL on machines of 64 bits that have the low byte of a number first")

; Where this is loaded again, `defpackage` would refuse the names that the types export besides.
(eval-when (:compile-toplevel :load-toplevel :execute)
  (unless (find-package '#:$package)
    (make-package '#:$package :use '(#:common-lisp))))

(in-package #:$package)

(export '(decode encode encode-into message-size codec make-codec reset *now* refused octets with-floats
          message-error decode-error encode-error message-error-kind message-error-path
          message-error-detail message-error-line message-error-offset))

(declaim (sb-ext:muffle-conditions sb-ext:compiler-note))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *proven* '(optimize (speed 1) (safety 0) (debug 0) (sb-ext:inhibit-warnings 3))
    "How functions are compiled whose every access is known to be safe: messages are checked by their own statements."))

;;; Names that macros make.

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun named (&rest parts)
    "The symbol whose name is those of PARTS, one behind the other, whatever *PRINT-CASE* is where this is compiled."
    (intern (format nil "~{~A~}" (mapcar #'string parts)))))

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

(defun sites (rows)
  "A vector of sites. Each row has what SITE takes, with forms in place of texts that are not in ASCII."
  (labels ((value (tree)
             (cond ((atom tree) tree)
                   ((eq (first tree) 'text) (apply #'text (rest tree)))
                   (t (mapcar #'value tree)))))
    (map 'vector (lambda (row) (apply #'site (value row))) rows)))

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

(deftype registers () '(simple-array i64 (*)))

(defun registers (&rest words)
  "What state variables hold: integers as they are, floats by their bits."
  (make-array (length words) :element-type 'i64 :initial-contents words))

(defstruct (codec-state (:copier nil) (:predicate nil))
  "What all codecs have: the last failure and the farthest one, what the mapping asks of its host, its state, what
forgets rows that messages have left, locals that several parts of a kernel use, and what passes between routines and
their callers."
  (failure (make-failure) :type failure)
  (farthest (make-failure) :type failure)
  (most 0 :type i64)
  (kept-f64 0d0 :type f64)
  (kept-f32 0f0 :type f32)
  (forget 'identity :type symbol)
  (now 0 :type i64)
  (number 0 :type i64)
  (first-registers (registers) :type registers)
  (unpack-registers (registers) :type registers)
  (pack-registers (registers) :type registers)
  (spilled (no-octets) :type octets)
  (u64-passed-1 0 :type u64)
  (u64-passed-2 0 :type u64)
  (u64-passed-3 0 :type u64)
  (u64-passed-4 0 :type u64)
  (i64-passed-1 0 :type i64)
  (i64-passed-2 0 :type i64)
  (i64-passed-3 0 :type i64)
  (i64-passed-4 0 :type i64)
  (i64-passed-5 0 :type i64)
  (i64-passed-6 0 :type i64))

(defun reset (codec)
  "Forget all messages: the mapping's state becomes what it is at first."
  (replace (codec-state-unpack-registers codec) (codec-state-first-registers codec))
  (replace (codec-state-pack-registers codec) (codec-state-first-registers codec))
  (funcall (codec-state-forget codec) codec)
  codec)

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
