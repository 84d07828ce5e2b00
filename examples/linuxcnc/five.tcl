# A machine of five axes with Abbe between the joints of its kinematics and the drives, wired as mill.hal wires three; the drives are
# those of a simulated machine. The letters of its axes, in the order of the joints, are [ABBE]AXES of the INI file.
eval loadrt $::KINS(KINEMATICS)
loadrt abbe calibration=$::ABBE(CALIBRATION)
loadrt $::EMCMOT(EMCMOT) servo_period_nsec=$::EMCMOT(SERVO_PERIOD) num_joints=$::KINS(JOINTS)
loadrt plant
loadrt sampler depth=8000 cfg=sffffssbf

# Feedback before the motion controller, commands after it.
foreach function {abbe.read motion-command-handler motion-controller abbe.update plant.update sampler.0} {
    addf $function servo-thread
}

# Joints of rotary axes are in degrees, as Abbe's pins of them are.
set joint 0
foreach axis [split [string tolower $::ABBE(AXES)] ""] {
    net $axis-position joint.$joint.pos-cmd => abbe.$axis.position plant.$axis.position
    net $axis-homed joint.$joint.homed => abbe.$axis.homed
    net $axis-cmd joint.$joint.motor-pos-cmd => abbe.$axis.cmd-in
    net $axis-drive-cmd abbe.$axis.cmd-out => plant.$axis.cmd
    net $axis-drive-fb plant.$axis.fb => abbe.$axis.fb-in
    net $axis-fb abbe.$axis.fb-out => joint.$joint.motor-pos-fb
    incr joint
}
net compensate => abbe.enable
net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in

# What the test looks at, in every servo cycle. five.py sets the phase.
net phase => sampler.0.pin.0
net x-error plant.x.error => sampler.0.pin.1
net y-error plant.y.error => sampler.0.pin.2
net z-error plant.z.error => sampler.0.pin.3
net turned plant.turned => sampler.0.pin.4
net status abbe.status => sampler.0.pin.5
net time abbe.time => sampler.0.pin.6
net machine-on motion.motion-enabled => sampler.0.pin.7
# The joint behind the slides tilts: where it is at zero the tool stands along C.
net [string tolower [string index $::ABBE(AXES) 3]]-position => sampler.0.pin.8
setp sampler.0.enable 1
