# SPDX-License-Identifier: BSD-3-Clause
# source tools/ros2_localhost.sh (bash, zsh): ROS 2 nodes of this shell look for a robot on this
# computer, where dds.interface = "lo" has it, and nowhere else. For rmw_fastrtps and
# rmw_cyclonedds. In Humble, `ros2 node list` lacks the robot, whose identifiers are as in later
# releases; its topics are there.
export ROS_DOMAIN_ID=42
# The loopback interface has no multicast: each process needs an index of its own, up to 119 as for
# the robot.
export CYCLONEDDS_URI='<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General><Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>119</MaxAutoParticipantIndex></Discovery>'
# The file beside this one; zsh has its path in %x.
FASTRTPS_DEFAULT_PROFILES_FILE=${BASH_SOURCE[0]:-${(%):-%x}}
FASTRTPS_DEFAULT_PROFILES_FILE=$(realpath -- "${FASTRTPS_DEFAULT_PROFILES_FILE%.sh}.xml")
export FASTRTPS_DEFAULT_PROFILES_FILE
export FASTDDS_DEFAULT_PROFILES_FILE=$FASTRTPS_DEFAULT_PROFILES_FILE  # its name since Fast DDS 3
[ -r "$FASTRTPS_DEFAULT_PROFILES_FILE" ] || {
  echo "ros2_localhost.sh: found no file '$FASTRTPS_DEFAULT_PROFILES_FILE', expected bash or zsh, and ros2_localhost.xml beside this script" >&2
  return 1
}
