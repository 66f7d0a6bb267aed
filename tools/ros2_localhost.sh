# SPDX-License-Identifier: BSD-3-Clause
# source tools/ros2_localhost.sh: ROS 2 nodes of this shell look for a robot on this computer, where dds.interface = "lo"
# has it, and nowhere else. For rmw_fastrtps and rmw_cyclonedds, from Humble on.
export ROS_DOMAIN_ID=42
export CYCLONEDDS_URI='<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>'
FASTRTPS_DEFAULT_PROFILES_FILE=$(realpath -- "${BASH_SOURCE[0]%.sh}.xml")
export FASTRTPS_DEFAULT_PROFILES_FILE
export FASTDDS_DEFAULT_PROFILES_FILE=$FASTRTPS_DEFAULT_PROFILES_FILE  # its name since Fast DDS 3
