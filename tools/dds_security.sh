#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# dds_security.sh DIR: creates the files for DDS Security in a new folder DIR: a certificate
# authority, the identities robot, operator and viewer with their permissions, and the rules of the
# domain. Run the robot with DIR as dds.security_dir. Give an operator's or viewer's computer only
# ca.pem, governance.p7s and the three files of its identity, never ca.key.
set -euo pipefail
for word; do
  case $word in -h | --help) sed -n '3,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac
done

fail() {
  echo "dds_security.sh: $1" >&2
  exit 2
}
(($# == 1)) || fail "found $# arguments, expected one, the folder to create: dds_security.sh DIR"
command -v openssl >/dev/null || fail "found no openssl, expected the Debian package openssl"
dir=$1
[[ ! -e $dir ]] || fail "found $dir, expected a folder that does not exist yet"
umask 077
# All or nothing: the folder gets its name at the end.
made=$(mktemp -d -- "$dir.XXXXXX") || fail "cannot create a folder beside $dir"
trap 'rm -rf -- "$made"' EXIT
made=$(realpath -- "$made")
start=$PWD
cd -- "$made"

telemetry=(rt/joint_states rt/imu/data rt/odom rt/tf rt/tf_static rt/robot_description rt/diagnostics rt/clock
  sandrunner/ticks sandrunner/mode_reply ros_discovery_info 'rr/sandrunner/*')
commands=(rt/cmd_vel sandrunner/mode_request rt/sandrunner/request 'rq/sandrunner/*')
days=3650
from=$(date -u +%Y-%m-%dT%H:%M:%S)
until=$(date -u -d "+$days days" +%Y-%m-%dT%H:%M:%S)
domains="<domains><id_range><min>0</min><max>230</max></id_range></domains>"

new_key() { openssl ecparam -genkey -name prime256v1 -noout -out "$1.key"; }
# Signs XML from standard input.
sign() { openssl smime -sign -text -signer ca.pem -inkey ca.key -out "$1.p7s" 2>/dev/null; }
# rule publish|subscribe TOPICS...
rule() {
  echo "<$1><topics>"
  printf '<topic>%s</topic>' "${@:2}"
  echo "</topics></$1>"
}

new_key ca
openssl req -x509 -new -key ca.key -days $days -sha256 -subj "/CN=sandrunner CA" -out ca.pem

identity() { # NAME, with the rules on standard input
  new_key "$1"
  openssl req -new -key "$1.key" -subj "/CN=$1" -out "$1.csr"
  openssl x509 -req -in "$1.csr" -CA ca.pem -CAkey ca.key -CAcreateserial -days $days -sha256 -out "$1.pem" 2>/dev/null
  rm "$1.csr"
  sign "$1.perm" <<EOF
<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
<permissions><grant name="$1"><subject_name>CN=$1</subject_name>
<validity><not_before>$from</not_before><not_after>$until</not_after></validity>
<allow_rule>$domains
$(cat)
</allow_rule><default>DENY</default></grant></permissions></dds>
EOF
}
{
  rule publish "${telemetry[@]}"
  rule subscribe "${commands[@]}"
} | identity robot
{
  rule publish "${commands[@]}"
  rule subscribe "${telemetry[@]}"
} | identity operator
rule subscribe "${telemetry[@]}" | identity viewer

# Nobody is seen, let alone heard, before they have proved who they are; everything on the wire is
# encrypted.
sign governance <<EOF
<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
<domain_access_rules><domain_rule>$domains
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>SIGN</discovery_protection_kind>
<liveliness_protection_kind>SIGN</liveliness_protection_kind>
<rtps_protection_kind>ENCRYPT</rtps_protection_kind>
<topic_access_rules><topic_rule><topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>SIGN</metadata_protection_kind>
<data_protection_kind>NONE</data_protection_kind>
</topic_rule></topic_access_rules></domain_rule></domain_access_rules></dds>
EOF
rm -f ca.srl
cd -- "$start"
mv -T -- "$made" "$dir"
echo "created $dir: ca, governance, and the identities robot, operator, viewer, valid until $until"
