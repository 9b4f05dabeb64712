;;; Decodes messages of three wires (a number from 0, a little-endian length, then bytes) into one object, and shows it behind each.

;; SBCL mentions to handlers that a class's own functions are defined when it is compiled and when it is loaded, and prints nothing of it.
(handler-bind ((warning (lambda (warning)
                          (unless (typep warning sb-ext:*muffled-warnings*)
                            (format *error-output* "~A~%" warning)
                            (sb-ext:exit :code 1 :abort t)))))
  (let ((*standard-output* (make-broadcast-stream)))
    (load (compile-file "seen.lisp"))))

(defun numbers (values)
  (format nil "[~{~A ~}]" (map 'list #'number-of values)))

(defun number-of (value)
  "A float with all of its digits, and its exponent behind a d."
  (prin1-to-string (coerce value 'double-float)))

(defun show (seen)
  (format t "ok ~A ~A ~A ~D ~A ~D ~A ~A ~{~A~^|~} ~D"
          (seen:seen-frame seen) (number-of (seen:seen-lead seen)) (numbers (seen:seen-ranges seen)) (or (seen:seen-count seen) -1000)
          (number-of (seen:seen-least seen)) (if (seen:seen-ready seen) 1 0) (number-of (seen:seen-tilt seen))
          (numbers (seen:seen-joined seen)) (coerce (seen:seen-names seen) 'list) (seen:seen-steps seen)))

(defun show-error (condition)
  (let ((line (seen:message-error-line condition)))
    (format t "~(~A~) ~D [~A] ~A~@[ (~A)~]" (seen:message-error-kind condition) (seen:message-error-offset condition)
            (seen:message-error-path condition) (seen:message-error-detail condition) (and (plusp (length line)) line))))

(defun octets-of (stream)
  "The next message, and its wire before it."
  (let ((head (make-array 5 :element-type '(unsigned-byte 8))))
    (when (= (read-sequence head stream) 5)
      (let ((octets (make-array (loop for at from 1 to 4 sum (ash (aref head at) (* 8 (1- at)))) :element-type '(unsigned-byte 8))))
        (read-sequence octets stream)
        (values octets (aref head 0))))))

(let ((stream (sb-sys:make-fd-stream 0 :element-type '(unsigned-byte 8) :buffering :full))
      (seen (seen:make-seen)))
  (loop
    (multiple-value-bind (octets wire) (octets-of stream)
      (unless octets (return))
      (handler-case
          (sb-int:with-float-traps-masked (:invalid :overflow :divide-by-zero)
            (ecase wire
              (0 (seen:decode-scan octets seen))
              (1 (seen:decode-pose octets seen))
              (2 (seen:decode-tilt octets seen)))
            (show seen))
        (seen:decode-error (condition) (show-error condition)))
      (format t "~{ ~D~}~%" (list (or (seen:age-scan) -1) (or (seen:age-pose) -1) (or (seen:age-tilt) -1)))))
  (seen:reset seen:*codec*)
  (when (seen:age-scan)
    (sb-ext:exit :code 1)))
