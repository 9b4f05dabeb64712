;;; Made by rosetta-jit. Changes will be lost.
;;; decode: yarp.icub.torso.state, yarp3 -> rst.kinematics.JointAngles, by torso_state.mapping
;;;   10: len(.angles) <-> 3
;;;   11: .angles[0] <-> float32(radians(.yaw))
;;;   12: .angles[1] <-> float32(radians(.roll))
;;;   13: .angles[2] <-> float32(radians(.pitch))
;;; encode: yarp.icub.torso.state, yarp3 <- rst.kinematics.JointAngles, by torso_state.mapping
;;;   10: len(.angles) <-> 3
;;;   11: .angles[0] <-> float32(radians(.yaw))
;;;   12: .angles[1] <-> float32(radians(.roll))
;;;   13: .angles[2] <-> float32(radians(.pitch))

(in-package #:torso-state)

(declaim (sb-ext:muffle-conditions sb-ext:compiler-note))

(export '(joint-angles make-joint-angles joint-angles-angles joint-angles-unknown-fields))

(defclass joint-angles ()
  ((angles :initarg :angles :type (simple-array f32 (*))
           :initform (make-array 0 :element-type 'f32)
           :documentation "Joint angles, in rad.")
   (unknown-fields :initarg :unknown-fields :type octets
                   :initform (no-octets)
                   :documentation "Fields that the schema does not know, as they came."))
  (:metaclass structure-class))
(define-operators joint-angles "rst.kinematics.JointAngles. Angles of the joints of a kinematic chain.")

(defconstant +angles.start+ 16)
(defconstant +angles.count+ 24)
(defconstant +unknown.start+ 0)
(defconstant +unknown.count+ 8)

(defstruct (codec (:include codec-state)
                  (:conc-name codec.)
                  (:constructor make-codec ())
                  (:copier nil)
                  (:predicate nil))
  "Memory that is kept from one message to the next. Each thread needs its own."
  (message (make-array 32 :element-type 'u8) :type octets)
  (unknown (make-array 0 :element-type 'u8) :type octets)
  (unknown-used 0 :type fixnum)
  (angles (make-array 0 :element-type 'u8) :type octets)
  (angles-used 0 :type fixnum)
  (scratch-0 (make-array 0 :element-type 'u8) :type octets)
  (scratch-0-used 0 :type fixnum))

(defparameter *decode-sites*
  (sites
    '((:count "" "the message asks for more memory than its size allows" "")
      (:trailing "" "not of the usual length" "")
      (:tag "" "must be 266" "")
      (:count "" "must be 3" "")
      (:truncated "" "the message ends here" "")
      (:truncated "" "the message ends here" "" :parts ((0 4 0 "") (4 8 0 ".yaw") (12 8 0 ".roll") (20 8 0 ".pitch")))
      (:trailing "" "bytes are left over" "")
      (:tag "" "must be one of 266, 256" "")
      (:truncated ""
                  "the message ends here"
                  ""
                  :parts
                  ((0 4 0 "")
                   (4 4 0 ".yaw")
                   (8 8 0 ".yaw")
                   (16 4 0 ".roll")
                   (20 8 0 ".roll")
                   (28 4 0 ".pitch")
                   (32 8 0 ".pitch")))
      (:tag ".yaw" "must be 10" "")
      (:tag ".roll" "must be 10" "")
      (:tag ".pitch" "must be 10" ""))))

(defun decode-kernel (codec data end attempt)
  (declare (optimize (speed 1) (safety 0) (debug 0) (compilation-speed 2)) (type codec codec) (type octets data)
           (type i64 end) (type fixnum attempt) (ignorable codec data end attempt))
  (labels
      ((decode-1 ()
         (let* ((message (codec.message codec))
                (angles (codec.angles codec))
                (angles-used 0)
                (start 0))
           (declare (type octets message angles) (type i64 angles-used start)
                    (ignorable message angles angles-used start))
           (when (/= 32 end)
             (return-from decode-1 (fail codec 1 -1)))  ; trailing: not of the usual length
           (fill-octets message 0 32 0)
           (when (/= (i32-at data 0) 266)
             (return-from decode-1 (fail codec 2 0)))  ; tag: must be 266
           (when (/= (i32-at data 4) 3)
             (return-from decode-1 (fail codec 3 4)))  ; count: must be 3
           (reserve (angles (codec.angles codec) 4) angles-used 3 codec (return-from decode-1 (full codec ".angles")))
           (setf start angles-used)
           (setf angles-used (i64+ angles-used 3))
           (setf (i64-at message +angles.start+) start)  ; torso_state.mapping:10: len(.angles) <-> 3
           (setf (i64-at message +angles.count+) 3)  ; torso_state.mapping:10: len(.angles) <-> 3
           ;; torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw))
           (setf (f32-at angles (row 4 start)) (f32-of-f64 (* (f64-at data 8) 0.017453292519943295d0)))
           ;; torso_state.mapping:12: .angles[1] <-> float32(radians(.roll))
           (setf (f32-at angles (row 4 (i64+ start 1))) (f32-of-f64 (* (f64-at data 16) 0.017453292519943295d0)))
           ;; torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch))
           (setf (f32-at angles (row 4 (i64+ start 2))) (f32-of-f64 (* (f64-at data 24) 0.017453292519943295d0)))
           (return-from decode-1 32)))
       (decode-2 ()
         (let* ((message (codec.message codec))
                (angles (codec.angles codec))
                (angles-used 0)
                (code 0)
                (start-2 0))
           (declare (type octets message angles) (type i64 angles-used code start-2)
                    (ignorable message angles angles-used code start-2))
           (fill-octets message 0 32 0)
           (when (< end 4)
             (return-from decode-2 (fail codec 4 0)))  ; truncated: the message ends here
           (setf code (i32-at data 0))
           (when (= code 266)
             (when (< end 32)
               (return-from decode-2 (fail codec 5 4)))  ; truncated: the message ends here
             (when (/= (i32-at data 4) 3)
               (return-from decode-2 (fail codec 3 4)))  ; count: must be 3
             (when (/= 32 end)
               (return-from decode-2 (fail codec 6 32)))  ; trailing: bytes are left over
             (return-from decode-2 (fail codec 1 -1)))  ; trailing: not of the usual length
           (when (/= code 256)
             (return-from decode-2 (fail codec 7 0)))  ; tag: must be one of 266, 256
           (when (< end 44)
             (return-from decode-2 (fail codec 8 4)))  ; truncated: the message ends here
           (when (/= (i32-at data 4) 3)
             (return-from decode-2 (fail codec 3 4)))  ; count: must be 3
           (when (/= (i32-at data 8) 10)
             (return-from decode-2 (fail codec 9 8)))  ; tag .yaw: must be 10
           (when (/= (i32-at data 20) 10)
             (return-from decode-2 (fail codec 10 20)))  ; tag .roll: must be 10
           (when (/= (i32-at data 32) 10)
             (return-from decode-2 (fail codec 11 32)))  ; tag .pitch: must be 10
           (reserve (angles (codec.angles codec) 4) angles-used 3 codec (return-from decode-2 (full codec ".angles")))
           (setf start-2 angles-used)
           (setf angles-used (i64+ angles-used 3))
           (setf (i64-at message +angles.start+) start-2)  ; torso_state.mapping:10: len(.angles) <-> 3
           (setf (i64-at message +angles.count+) 3)  ; torso_state.mapping:10: len(.angles) <-> 3
           ;; torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw))
           (setf (f32-at angles (row 4 start-2)) (f32-of-f64 (* (f64-at data 12) 0.017453292519943295d0)))
           ;; torso_state.mapping:12: .angles[1] <-> float32(radians(.roll))
           (setf (f32-at angles (row 4 (i64+ start-2 1))) (f32-of-f64 (* (f64-at data 24) 0.017453292519943295d0)))
           ;; torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch))
           (setf (f32-at angles (row 4 (i64+ start-2 2))) (f32-of-f64 (* (f64-at data 36) 0.017453292519943295d0)))
           (when (/= 44 end)
             (return-from decode-2 (fail codec 6 44)))  ; trailing: bytes are left over
           (return-from decode-2 44))))
    (case attempt (1 (decode-1)) (t (decode-2)))))

(defparameter *encode-sites*
  (sites
    '((:count "" "the message asks for more memory than its size allows" "")
      (:length ".angles" "the holder is damaged" "")
      (:length ""
               "no room for the message"
               ""
               :parts
               ((0 4 0 "") (4 4 0 "") (8 8 0 ".yaw") (16 8 0 ".roll") (24 8 0 ".pitch")))
      (:index ".angles[{}]" "no such element" "torso_state.mapping:11:3")
      (:index ".angles[{}]" "no such element" "torso_state.mapping:12:3")
      (:index ".angles[{}]" "no such element" "torso_state.mapping:13:3")
      (:rejected "" "`len(.angles)` is not `3`, as the mapping says" "torso_state.mapping:10:3"))))

(defun encode-kernel (codec data end attempt)
  (declare (optimize (speed 1) (safety 0) (debug 0) (compilation-speed 2)) (type codec codec) (type octets data)
           (type i64 end) (type fixnum attempt) (ignorable codec data end attempt))
  (labels
      ((encode-1 ()
         (let* ((message (codec.message codec))
                (angles (codec.angles codec))
                (angles-used (codec.angles-used codec))
                (start (i64-at message +angles.start+))
                (count (i64-at message +angles.count+))
                (element 0.0f0)
                (yaw 0.0d0)
                (element-2 0.0f0)
                (roll 0.0d0)
                (element-3 0.0f0)
                (pitch 0.0d0))
           (declare (type octets message angles) (type i64 angles-used start count)
                    (type f32 element element-2 element-3) (type f64 yaw roll pitch)
                    (ignorable message angles angles-used start count element yaw element-2 roll element-3 pitch))
           (unless (and (>= count 0) (<= count angles-used))
             (return-from encode-1 (fail codec 1 0)))  ; length .angles: the holder is damaged
           (unless (and (>= start 0) (<= start (i64- angles-used count)))
             (return-from encode-1 (fail codec 1 0)))  ; length .angles: the holder is damaged
           (when (< end 32)
             (return-from encode-1 (fail codec 2 0)))  ; length: no room for the message
           (setf (i32-at data 0) 266)
           (setf (i32-at data 4) 3)
           (when (>= 0 count)
             (return-from encode-1 (fail codec 3 8 0)))  ; index .angles[{}]: no such element (torso_state.mapping:11:3)
           (setf element (f32-at angles (row 4 start)))  ; torso_state.mapping:11: .angles[0] <-> float32(radians(.yaw))
           (setf yaw (* (f64-of-f32 element) 57.29577951308232d0))
           (setf (f64-at data 8) yaw)
           (when (>= 1 count)
             (return-from encode-1 (fail codec 4 16 1)))  ; index .angles[{}]: no such element (torso_state.mapping:12:3)
           (setf element-2 (f32-at angles (row 4 (i64+ start 1))))  ; torso_state.mapping:12: .angles[1] <-> float32(radians(.roll))
           (setf roll (* (f64-of-f32 element-2) 57.29577951308232d0))
           (setf (f64-at data 16) roll)
           (when (>= 2 count)
             (return-from encode-1 (fail codec 5 24 2)))  ; index .angles[{}]: no such element (torso_state.mapping:13:3)
           (setf element-3 (f32-at angles (row 4 (i64+ start 2))))  ; torso_state.mapping:13: .angles[2] <-> float32(radians(.pitch))
           (setf pitch (* (f64-of-f32 element-3) 57.29577951308232d0))
           (setf (f64-at data 24) pitch)
           (when (/= count 3)
             (return-from encode-1 (fail codec 6 32)))  ; rejected: `len(.angles)` is not `3`, as the mapping says (torso_state.mapping:10:3)
           (return-from encode-1 32))))
    (encode-1)))

(defparameter *size-sites*
  (sites
    '((:count "" "the message asks for more memory than its size allows" "")
      (:length ".angles" "the holder is damaged" ""))))

(defun size-kernel (codec data end attempt)
  (declare (optimize (speed 1) (safety 0) (debug 0) (compilation-speed 2)) (type codec codec) (type octets data)
           (type i64 end) (type fixnum attempt) (ignorable codec data end attempt))
  (labels
      ((size-1 ()
         (let* ((message (codec.message codec))
                (angles-used (codec.angles-used codec))
                (start (i64-at message +angles.start+))
                (count (i64-at message +angles.count+)))
           (declare (type octets message) (type i64 angles-used start count) (ignorable message angles-used start count))
           (unless (and (>= count 0) (<= count angles-used))
             (return-from size-1 (fail codec 1 0)))  ; length .angles: the holder is damaged
           (unless (and (>= start 0) (<= start (i64- angles-used count)))
             (return-from size-1 (fail codec 1 0)))  ; length .angles: the holder is damaged
           (return-from size-1 32))))
    (size-1)))

(defun take-message (codec data row before)
  (declare (type codec codec) (type octets data) (type fixnum row) (ignorable codec data row))
  (let ((object (if (typep before 'joint-angles) before (make-joint-angles))))
    (setf (joint-angles-angles object)
          (f32s (joint-angles-angles object)
                (codec.angles codec)
                (i64-at (codec.message codec) +angles.start+)
                (i64-at (codec.message codec) +angles.count+)))
    (setf (joint-angles-unknown-fields object)
          (u8s (joint-angles-unknown-fields object)
               (codec.unknown codec)
               (i64-at (codec.message codec) +unknown.start+)
               (i64-at (codec.message codec) +unknown.count+)
               data))
    object))

(defun put-message (codec row object)
  (declare (type codec codec) (type fixnum row) (type joint-angles object) (ignorable codec row object))
  (put-span ((codec.message codec) +angles.start+)
            ((codec.angles codec) (codec.angles-used codec))
            append-f32s
            (joint-angles-angles object))
  (put-span ((codec.message codec) +unknown.start+)
            ((codec.unknown codec) (codec.unknown-used codec))
            append-u8s
            (joint-angles-unknown-fields object))
  object)

(defun decode (octets &key (end (length octets)) (codec (make-codec)) before)
  "The object of a message: bytes 0 to END of a vector. BEFORE is an object that is filled instead of a new one.

Signals DECODE-ERROR. With a codec and an object that are used again, numbers are read without allocating memory."
  (declare (type codec codec) (type (or null joint-angles) before))
  (let ((data (if (typep octets 'octets) octets (coerce octets 'octets))))
    (declare (type octets data))
    (check-type end (integer 0))
    (assert (<= end (length data)) (end))
    (setf (codec-state-most codec) (+ 1048576 (* 64 end)))
    (unless (with-floats (attempts codec #'decode-kernel data end 2))
      (signal-failure codec *decode-sites* end))
    (take-message codec data 0 before)))

(defun collect-message (codec object)
  "Bring an object into the rows of a codec."
  (declare (type codec codec))
  (setf (codec-state-most codec) most-positive-fixnum
        (codec.unknown-used codec) 0
        (codec.angles-used codec) 0)
  (fill (codec.message codec) 0)
  (let ((*where* '()))
    (handler-case (put-message codec 0 object)
      (type-error (condition) (unfit (misfit condition)))
      (encode-error (condition) (unfit (message-error-detail condition))))))

(defun size-of-rows (codec)
  (or (with-floats (attempts codec #'size-kernel (load-time-value (no-octets) t) (ash 1 60) 1))
      (signal-failure codec *size-sites* nil)))

(defun encode-rows (codec data)
  (declare (type octets data))
  (or (with-floats (attempts codec #'encode-kernel data (length data) 1))
      (signal-failure codec *encode-sites* nil)))

(defun message-size (object &key (codec (make-codec)))
  "How many bytes the message of an object has. Signals ENCODE-ERROR."
  (collect-message codec object)
  (size-of-rows codec))

(defun encode-into (octets object &key (codec (make-codec)))
  "Write the message of an object to a vector from its byte 0 on; gives where it ends. Signals ENCODE-ERROR.

With a codec that is used again, numbers are written without allocating memory."
  (check-type octets octets)
  (collect-message codec object)
  (encode-rows codec octets))

(defun encode (object &key (codec (make-codec)))
  "The message of an object, a vector of octets. Signals ENCODE-ERROR."
  (collect-message codec object)
  (let* ((size (size-of-rows codec))
         (octets (make-array size :element-type 'u8))
         (written (encode-rows codec octets)))
    (if (= written size) octets (subseq octets 0 written))))
