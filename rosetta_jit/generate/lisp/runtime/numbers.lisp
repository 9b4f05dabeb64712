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

;;; Arithmetic of one type, whose results are known to fit: (i64+ a b), (u8* a b) and so on. (u64+% a b) keeps the low bits.

(defmacro define-arithmetic (type bits)
  `(progn
     ,@(loop for operator in '(+ - *)
             collect `(defmacro ,(named type operator) (left right)
                        `(the ,',type (,',operator (the ,',type ,left) (the ,',type ,right)))))
     (defmacro ,(named type '/) (left right)
       `(the ,',type (values (truncate (the ,',type ,left) (the ,',type ,right)))))
     (defmacro ,(named type '-rem) (left right)
       `(the ,',type (rem (the ,',type ,left) (the ,',type ,right))))
     (defmacro ,(named type '+%) (left right)
       `(,',(named "WRAP-" type) (+ (the ,',type ,left) (the ,',type ,right))))
     (defmacro ,(named type '-neg) (value)
       `(the ,',type (- (the ,',type ,value))))
     (defmacro ,(named type '-abs) (value)
       `(the ,',type (abs (the ,',type ,value))))
     (defmacro ,(named type '>>) (value by)
       `(the ,',type (ash (the ,',type ,value) (- (the (integer 0 ,',(1- bits)) ,by)))))
     (defmacro ,(named type '<<) (value by)
       `(,',(named "WRAP-" type)
         (ash (the u64 (wrap-u64 (the ,',type ,value))) (the (integer 0 ,',(1- bits)) ,by))))))

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
                 f64-min f64-max f32-min f32-max f64-sqrt f32-sqrt f64-rem f32-rem))

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
