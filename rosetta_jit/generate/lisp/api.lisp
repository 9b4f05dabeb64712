;; == decode
(defun decode (octets &key (end (length octets)) (codec $codec) before)
  "The object of a message: bytes 0 to END of a vector. BEFORE is an object that is filled instead of a new one.

Signals DECODE-ERROR. With a codec and an object that are used again, numbers are read without allocating memory."
  (declare (type codec codec) (type (or null $type) before))
  (let ((data (if (typep octets 'octets) octets (coerce octets 'octets))))
    (declare (type octets data))
    (check-type end (integer 0))
    (assert (<= end (length data)) (end))
    (setf (codec-state-most codec) (+ 1048576 (* 64 end)))
    $tell
    (unless ($begin (attempts codec #'decode-kernel data end $attempts))
      (signal-failure codec *decode-sites* end))
    ($take codec data 0 before)))
;; == wire
(defun $decode (octets into &key (end (length octets)) (codec *codec*))
  "Read a message of $wire, bytes 0 to END of a vector, and set what its messages tell of an object, which is given back.

Signals DECODE-ERROR, and changes nothing then. What arrays hold that several wires fill is the codec's."
  (declare (type codec codec) (type $type into))
  (let ((data (if (typep octets 'octets) octets (coerce octets 'octets))))
    (declare (type octets data))
    (check-type end (integer 0))
    (assert (<= end (length data)) (end))
    (setf (codec-state-most codec) (+ 1048576 (* 64 end)))
    $tell
    (setf $save)
    (unless ($begin (attempts codec #'$decode-kernel data end $attempts))
      $restore
      (signal-failure codec *$decode-sites* end))
    ($share codec data 0 into)))

(defun $age (&optional (codec *codec*))
  "How many messages of all wires have been decoded since the last one of $wire; nil before the first."
  (let* ((registers (codec-state-unpack-registers codec)) (last (aref registers $last)))
    (if (zerop last) nil (- (aref registers $every) last))))
;; == wires
(defun forget-rows (codec)
  (fill (codec.message codec) 0)
  (setf $emptied)
  codec)
;; == writer
(defun writer (codec)
  "A codec for what is written: rows that messages have left stay."
  (declare (type codec codec))
  (or (codec.writer codec) (setf (codec.writer codec) (make-codec))))
;; == encode
(defun collect-message (codec object)
  "Bring an object into the rows of a codec."
  (declare (type codec codec))
  (setf (codec-state-most codec) most-positive-fixnum$empty)
  (fill (codec.message codec) 0)
  (let ((*where* '()))
    (handler-case ($put codec 0 object)
      (type-error (condition) (unfit (misfit condition)))
      (encode-error (condition) (unfit (message-error-detail condition)))))
  $tell)

(defun size-of-rows (codec)
  (or ($begin (attempts codec #'size-kernel (load-time-value (no-octets) t) (ash 1 60) 1))
      (signal-failure codec *size-sites* nil)))

(defun encode-rows (codec data)
  (declare (type octets data))
  (or ($begin (attempts codec #'encode-kernel data (length data) $attempts))
      (signal-failure codec *encode-sites* nil)))

(defun message-size (object &key (codec $codec))
  "How many bytes the message of an object has. Signals ENCODE-ERROR."
  $apart
  (collect-message codec object)
  (size-of-rows codec))

(defun encode-into (octets object &key (codec $codec))
  "Write the message of an object to a vector from its byte 0 on; gives where it ends. Signals ENCODE-ERROR.

With a codec that is used again, numbers are written without allocating memory."
  (check-type octets octets)
  $apart
  (collect-message codec object)
  $measure
  (encode-rows codec octets))

(defun encode (object &key (codec $codec))
  "The message of an object, a vector of octets. Signals ENCODE-ERROR."
  $apart
  (collect-message codec object)
  (let* ((size (size-of-rows codec))
         (octets (make-array size :element-type 'u8))
         (written (encode-rows codec octets)))
    (if (= written size) octets (subseq octets 0 written))))
