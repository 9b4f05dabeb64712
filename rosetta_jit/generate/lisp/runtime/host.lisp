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
