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

(defmacro run-part (part function)
  "Run a part of FUNCTION, which gives 0, or what the function ends with: it has failed."
  (let ((ended (gensym "ENDED")))
    `(let ((,ended ,part))
       (declare (type fixnum ,ended))
       (unless (= ,ended 0)
         (return-from ,function ,ended)))))

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

(defun saved (spare octets)
  "A copy of octets, in SPARE where that has their length."
  (declare (type octets spare octets))
  (if (= (length spare) (length octets)) (replace spare octets) (copy-seq octets)))

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

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun kept (place codec number)
    "The form of a number that has gone by way of a slot of the codec: the compiler draws no conclusions from it.

From (< x 0d0) being false it would conclude that x is positive, which holds neither of NaN nor of -0."
    (if (floatp number) number `(progn (setf (,place ,codec) ,number) (,place ,codec))))

  (defun compared (operator place codec left right)
    (let ((one (gensym "LEFT")) (other (gensym "RIGHT")) (strict (case operator (<= '<) (>= '>))))
      `(let ((,one ,(kept place codec left)) (,other ,(kept place codec right)))
         ,(if strict `(or (,strict ,one ,other) (= ,one ,other)) `(,operator ,one ,other))))))

(defmacro define-comparisons (type place)
  "(f64< codec a b) and so on."
  `(progn
     ,@(loop for operator in '(< > = /= <= >=)
             collect `(defmacro ,(named type operator) (codec left right)
                        (compared ',operator ',place codec left right)))))

(define-comparisons f64 codec-state-kept-f64)
(define-comparisons f32 codec-state-kept-f32)
