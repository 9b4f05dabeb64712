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
