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

(asdf:defsystem "torso-state"
  :description "Messages: decode: yarp.icub.torso.state, yarp3 -> rst.kinematics.JointAngles, by torso_state.mapping"
  :components ((:file "torso-state-runtime")
               (:file "torso-state" :depends-on ("torso-state-runtime"))))
