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
