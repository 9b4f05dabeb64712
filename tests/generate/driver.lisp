;;; A program around generated units: it decodes messages, writes them again, and says what is wrong with those that are broken.
;;;
;;; All units of a process share the runtime of the first, in whose symbols the packages of the others have a part.

(defvar *runtime* nil "The package of the runtime.")

(defun load-source (path)
  "A file that the compiler has nothing to say about."
  (multiple-value-bind (fasl warned) (let ((*standard-output* *error-output*)) (compile-file path))
    (when warned
      (format *error-output* "~A is not clean~%" path)
      (sb-ext:exit :code 1))
    (load fasl)))

(defparameter *own* '("DECODE" "ENCODE" "ENCODE-INTO" "MESSAGE-SIZE" "CODEC" "MAKE-CODEC") "What each unit defines itself.")

(defun is-defined (symbol)
  (or (fboundp symbol) (boundp symbol) (find-class symbol nil) (sb-int:info :type :expander symbol)))

(defun share (package)
  "A package in which the names that the runtime defines are those of the runtime."
  (let ((made (make-package package :use '(#:common-lisp))))
    (do-symbols (symbol *runtime*)
      (cond ((not (eq (symbol-package symbol) *runtime*)))
            ((member (symbol-name symbol) *own* :test #'string=) (export (list (intern (symbol-name symbol) made)) made))
            ((is-defined symbol) (import (list symbol) made))))))

(defun runtime (fasl)
  "What all units share, compiled."
  (load fasl)
  (setf *runtime* (find-package "RUNTIME")))

(defun unit (folder package)
  (share (string-upcase package))
  (load-source (merge-pathnames (format nil "~A.lisp" package) folder)))

(declaim (ftype function show-bits show-all))

(defun show (value stream)
  "A value in a form that does not depend on the language."
  (typecase value
    ((or null (eql t) (eql :absent) integer) (format stream "~(~A~)" value))
    (double-float (show-bits stream (= value value) (ldb (byte 64 0) (sb-kernel:double-float-bits value))))
    (single-float (show-bits stream (= value value) (ldb (byte 32 0) (sb-kernel:single-float-bits value))))
    (string (format stream "\"~{~D~^.~}\"" (map 'list #'char-code value)))
    (vector (write-char #\[ stream) (show-all (coerce value 'list) stream) (write-char #\] stream))
    (hash-table
     (let ((entries (loop for key being the hash-keys of value using (hash-value mapped)
                          collect (with-output-to-string (text) (show key text) (write-char #\: text) (show mapped text)))))
       (format stream "{~{~A~^ ~}}" (sort entries #'string<))))
    (cons (format stream "<~(~A~) " (car value)) (show (cdr value) stream) (write-char #\> stream))
    (structure-object
     (write-char #\( stream)
     (show-all (loop for (slot . others) on (sb-mop:class-slots (class-of value)) ; unknown fields come last, whatever the others are called
                     unless (and (null others) (eql 0 (search "UNKNOWN-FIELDS" (string (sb-mop:slot-definition-name slot)))))
                       collect (slot-value value (sb-mop:slot-definition-name slot)))
               stream)
     (write-char #\) stream))))

(defun show-bits (stream is-number bits)
  (if is-number (format stream "#~(~X~)" bits) (write-string "nan" stream)))

(defun show-all (values stream)
  (loop for value in values
        for first = t then nil
        do (unless first (write-char #\Space stream))
           (show value stream)))

(defun hexadecimal (octets stream)
  (loop for octet across octets do (format stream "~(~2,'0X~)" octet)))

(defun named (name package)
  (find-symbol (string-upcase name) (string-upcase package)))

(defun answer (package octets stream)
  (flet ((call (name &rest arguments)
           (apply (named name package) arguments))
         (of (name condition)
           (funcall (find-symbol name *runtime*) condition)))
    (handler-case
        (sb-int:with-float-traps-masked (:invalid :overflow :divide-by-zero)
          (let* ((object (call "decode" octets)) (value (with-output-to-string (text) (show object text))) (again (call "encode" object)))
            (write-string "ok " stream)
            (hexadecimal again stream)
            (format stream " ~A" value)))
      (error (condition)
        (if (typep condition (find-symbol "MESSAGE-ERROR" *runtime*))
            (format stream "~&~(~A~)~@[ ~D~] [~A] ~A~@[ (~A)~]"
                    (of "MESSAGE-ERROR-KIND" condition) (of "MESSAGE-ERROR-OFFSET" condition) (of "MESSAGE-ERROR-PATH" condition)
                    (of "MESSAGE-ERROR-DETAIL" condition)
                    (let ((line (of "MESSAGE-ERROR-LINE" condition))) (and (plusp (length line)) line)))
            (format stream "~&CRASH ~A" condition))))
    (terpri stream)))

(defun answers (package path)
  "Say of each message of a file, whose size stands before it, what a unit says."
  (let ((stream (sb-sys:make-fd-stream 1 :output t :external-format :utf-8 :buffering :full)))
    (with-open-file (file path :element-type '(unsigned-byte 8))
      (loop for size = (loop for shift below 32 by 8
                             for octet = (read-byte file nil)
                             while octet sum (ash octet shift) into sum
                             finally (return (and (= shift 32) sum)))
            while size
            do (let ((octets (make-array size :element-type '(unsigned-byte 8))))
                 (read-sequence octets file)
                 (answer package octets stream))))
    (finish-output stream)))

;;; Kernels without a unit: their rows come and go as hexadecimal text.

(defun octets-of (text)
  (let ((octets (make-array (floor (length text) 2) :element-type '(unsigned-byte 8))))
    (dotimes (number (length octets) octets)
      (setf (aref octets number) (parse-integer text :start (* 2 number) :end (* 2 (1+ number)) :radix 16)))))

(defun kernel (package path)
  (share (string-upcase package))
  (load-source path)
  (format t "ready~%")
  (finish-output))

(defun run-kernel (package attempts most lanes message)
  "Run a kernel on a message and on lanes, which are names and sizes; print its result, the failure, and the lanes."
  (let* ((codec (funcall (named "make-codec" package)))
         (octets (octets-of message))
         (failure (slot-value codec (find-symbol "FARTHEST" *runtime*))))
    (flet ((of (name)
             (slot-value failure (find-symbol name *runtime*))))
      (setf (slot-value codec (find-symbol "MOST" *runtime*)) most)
      (loop for (name size) in lanes
            do (setf (slot-value codec (named name package)) (make-array size :element-type '(unsigned-byte 8) :initial-element 0)))
      (let ((result (sb-int:with-float-traps-masked (:invalid :overflow :divide-by-zero)
                      (funcall (find-symbol "ATTEMPTS" *runtime*) codec (symbol-function (named "decode-kernel" package))
                               octets (length octets) attempts))))
        (if result
            (format t "ok~{ ~A~}~%"
                    (loop for (name) in lanes
                          collect (with-output-to-string (text)
                                    (hexadecimal (slot-value codec (named name package)) text))))
            (format t "failed ~D ~D ~D ~D ~D ~D ~A~%" (of "SITE") (of "AT") (of "INDEX-1") (of "INDEX-2") (of "INDEX-3") (of "INDEX-4")
                    (of "PATH")))
        (finish-output)))))
