// SPDX-License-Identifier: BSD-3-Clause
// An independent peer, on eProsima's Fast DDS as ROS 2's rmw_fastrtps uses it:
//   fastdds_peer DOMAIN VX_MPS SECONDS DISCOVERY
// Sends Twists at 50 Hz and receives every ROS topic with a ROS 2 node's default QoS; prints for
// each topic how many messages came and what was in the last one.
//   fastdds_peer DOMAIN call REQUEST DISCOVERY
// Calls the service /sandrunner/REQUEST as rmw_cyclonedds would, and prints the reply and the nodes
// of ros_discovery_info.
// DISCOVERY is how it looks for the robot: "loopback", or "profile": as rmw_fastrtps, with the
// default settings or those of the file that the environment names.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <memory>
#include <string>
#include <thread>

#include "tests/support/fastdds_loopback.h"
#ifdef SANDRUNNER_FASTDDS_3
#include "rosPubSubTypes.hpp"
#else
#include "rosPubSubTypes.h"
#endif

namespace {

namespace dds = eprosima::fastdds::dds;

dds::DomainParticipantQos participant_qos(const std::string& discovery) {
  if (discovery == "profile") {
    dds::DomainParticipantFactory::get_instance()->load_profiles();
    dds::DomainParticipantQos qos =
        dds::DomainParticipantFactory::get_instance()->get_default_participant_qos();
    sandrunner::send_no_type_information(qos);
    return qos;
  }
  return sandrunner::fastdds_loopback_qos();
}

template <typename PubSubType>
dds::Topic* make_topic(dds::DomainParticipant* participant, const char* topic, const char* type) {
  sandrunner::named_type<PubSubType>(type).register_type(participant);
  return participant->create_topic(topic, type, dds::TOPIC_QOS_DEFAULT);
}

// One topic that is received: its reader, how many messages came, the last one.
template <typename PubSubType>
struct Received {
  Received(dds::DomainParticipant* participant, dds::Subscriber* subscriber, const char* topic,
           const char* type, bool latched = false) {
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind =
        latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 10;
    reader = subscriber->create_datareader(make_topic<PubSubType>(participant, topic, type), qos);
  }
  void take() {
    dds::SampleInfo info;
    typename PubSubType::type sample;
    while (reader->take_next_sample(&sample, &info) == sandrunner::kReturnedOk) {
      if (!info.valid_data) continue;
      last = sample;
      ++count;
    }
  }
  dds::DataReader* reader;
  typename PubSubType::type last;
  int count = 0;
};

dds::DomainParticipant* make_participant(int domain, const std::string& discovery) {
  return dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<dds::DomainId_t>(domain), participant_qos(discovery));
}

void call(int domain, const std::string& request, const std::string& discovery) {
  dds::DomainParticipant* participant = make_participant(domain, discovery);
  dds::Subscriber* subscriber = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  dds::Publisher* publisher = participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  Received<std_srvs::srv::dds_::Trigger_Response_PubSubType> reply(
      participant, subscriber, ("rr/sandrunner/" + request + "Reply").c_str(),
      "std_srvs::srv::dds_::Trigger_Response_");
  Received<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType> nodes(
      participant, subscriber, "ros_discovery_info",
      "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_", true);
  dds::DataWriter* writer = publisher->create_datawriter(
      make_topic<std_srvs::srv::dds_::Trigger_Request_PubSubType>(
          participant, ("rq/sandrunner/" + request + "Request").c_str(),
          "std_srvs::srv::dds_::Trigger_Request_"),
      dds::DATAWRITER_QOS_DEFAULT);
  std_srvs::srv::dds_::Trigger_Request_ message;
  message.client(0x0123456789abcdef);
  message.number(7);
  // Once it has found the robot, and again after a second without an answer: the robot may not yet
  // have found it.
  int wait = 0;
  for (int i = 0; i < 500 && (reply.count == 0 || nodes.count == 0); ++i) {
    dds::PublicationMatchedStatus readers;
    dds::SubscriptionMatchedStatus writers;
    writer->get_publication_matched_status(readers);
    reply.reader->get_subscription_matched_status(writers);
    if (readers.current_count > 0 && writers.current_count > 0 && wait-- == 0) {
      writer->write(&message);
      wait = 100;
    }
    reply.take();
    nodes.take();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("client %llx number %lld success %d message %s\n",
              static_cast<unsigned long long>(reply.last.client()),
              static_cast<long long>(reply.last.number()), reply.last.success(),
              reply.last.message().c_str());
  for (const auto& node : nodes.last.node_entities_info_seq()) {
    std::printf("node %s%s readers %zu writers %zu\n", node.node_namespace().c_str(),
                node.node_name().c_str(), node.reader_gid_seq().size(),
                node.writer_gid_seq().size());
  }
}

void run(int domain, double vx_mps, double duration_s, const std::string& discovery) {
  dds::DomainParticipant* participant = make_participant(domain, discovery);
  dds::Subscriber* subscriber = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  dds::Publisher* publisher = participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  Received<sensor_msgs::msg::dds_::JointState_PubSubType> joints(
      participant, subscriber, "rt/joint_states", "sensor_msgs::msg::dds_::JointState_");
  Received<sensor_msgs::msg::dds_::Imu_PubSubType> imu(participant, subscriber, "rt/imu/data",
                                                       "sensor_msgs::msg::dds_::Imu_");
  Received<nav_msgs::msg::dds_::Odometry_PubSubType> odom(participant, subscriber, "rt/odom",
                                                          "nav_msgs::msg::dds_::Odometry_");
  Received<tf2_msgs::msg::dds_::TFMessage_PubSubType> tf(participant, subscriber, "rt/tf",
                                                         "tf2_msgs::msg::dds_::TFMessage_");
  Received<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType> diagnostics(
      participant, subscriber, "rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_");
  Received<std_msgs::msg::dds_::String_PubSubType> description(
      participant, subscriber, "rt/robot_description", "std_msgs::msg::dds_::String_", true);

  Received<tf2_msgs::msg::dds_::TFMessage_PubSubType> tf_static(
      participant, subscriber, "rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", true);

  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  dds::DataWriter* writer = publisher->create_datawriter(
      make_topic<geometry_msgs::msg::dds_::Twist_PubSubType>(participant, "rt/cmd_vel",
                                                             "geometry_msgs::msg::dds_::Twist_"),
      qos);
  geometry_msgs::msg::dds_::Twist_ twist;
  twist.linear().x(vx_mps);
  twist.angular().z(0.25);

  const int cycles = static_cast<int>(duration_s * 50.0);
  int sent = 0;
  for (int i = 0; i < cycles; ++i) {
    dds::PublicationMatchedStatus matched;
    writer->get_publication_matched_status(matched);
    if (matched.current_count > 0) {
      writer->write(&twist);
      ++sent;
    }
    joints.take();
    imu.take();
    odom.take();
    tf.take();
    diagnostics.take();
    description.take();
    tf_static.take();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

  std::printf("sent %d\n", sent);
  const auto& j = joints.last;
  std::printf("joint_states %d stamp %d.%09u frame %s names %zu", joints.count,
              j.header().stamp().sec(), j.header().stamp().nanosec(), j.header().frame_id().c_str(),
              j.name().size());
  for (std::size_t i = 0; i < j.name().size(); ++i) {
    std::printf(" %s %.6f %.6f %.6f", j.name()[i].c_str(), j.position().at(i), j.velocity().at(i),
                j.effort().at(i));
  }
  const auto& u = imu.last;
  std::printf("\nimu %d wxyz %.6f %.6f %.6f %.6f gyro %.3f %.3f %.3f acc %.3f %.3f %.3f\n",
              imu.count, u.orientation().w(), u.orientation().x(), u.orientation().y(),
              u.orientation().z(), u.angular_velocity().x(), u.angular_velocity().y(),
              u.angular_velocity().z(), u.linear_acceleration().x(), u.linear_acceleration().y(),
              u.linear_acceleration().z());
  const auto& o = odom.last;
  std::printf("odom %d frames %s %s y %.6f z %.3f vx %.3f yaw_variance %.9f\n", odom.count,
              o.header().frame_id().c_str(), o.child_frame_id().c_str(),
              o.pose().pose().position().y(), o.pose().pose().position().z(),
              o.twist().twist().linear().x(), o.pose().covariance()[35]);
  std::printf("tf %d", tf.count);
  for (const auto& t : tf.last.transforms()) {
    std::printf(" %s %s y %.6f w %.6f", t.header().frame_id().c_str(), t.child_frame_id().c_str(),
                t.transform().translation().y(), t.transform().rotation().w());
  }
  std::printf("\ndiagnostics %d", diagnostics.count);
  for (const auto& s : diagnostics.last.status()) {
    std::printf(" %s level %d message %s", s.name().c_str(), s.level(), s.message().c_str());
    for (const auto& v : s.values()) std::printf(" %s=%s", v.key().c_str(), v.value().c_str());
  }
  std::printf("\ntf_static %d", tf_static.count);
  for (const auto& t : tf_static.last.transforms()) {
    std::printf(" %s %s", t.header().frame_id().c_str(), t.child_frame_id().c_str());
  }
  std::printf("\nrobot_description %d %s\n", description.count, description.last.data().c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const int domain = std::atoi(argv[1]);
  if (std::string(argv[2]) == "call") {
    call(domain, argv[3], argv[4]);
  } else {
    run(domain, std::atof(argv[2]), std::atof(argv[3]), argv[4]);
  }
  std::fflush(stdout);
  std::_Exit(0);  // without telling its peers
}
