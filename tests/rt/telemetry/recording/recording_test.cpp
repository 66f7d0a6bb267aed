// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "rt/base/errors.h"
#include "rt/telemetry/mcap/mcap_reader.h"
#include "rt/telemetry/recording/cdr.h"
#include "rt/telemetry/recording/recording_file.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/rt/telemetry/mcap_content.h"
#include "tests/rt/telemetry/recording/recording_program.h"
#include "tests/support/small_robot.h"
#include "tests/support/text_match.h"
#include "tests/support/wait_until.h"

namespace sandrunner {
namespace {

class RecordingTest : public RecordingProgramTest {
 protected:
  std::string path() const { return folder_.path("run.mcap"); }

  /// Records a short lockstep walk.
  void record(const std::string& more = "") {
    ASSERT_EQ(run(SANDRUNNER_PROGRAM,
                  "--start walk --duration 0.5 --command 1,0,0 --set "
                  "sim.noise.joint_velocity_radps=0.1 --record '" +
                      folder_.path("") + "' " + more),
              0)
        << output();
  }
};

TEST_F(RecordingTest, HoldsEveryTickAndReplaysBitForBit) {
  record();
  std::uint64_t next = 0;
  const RecordingContents contents = read_ticks(
      path(), [&](const TickRecord& record) { return record.input.sensors.tick == next++; });
  EXPECT_TRUE(contents.complete);
  EXPECT_EQ(contents.ticks, 2000u);
  EXPECT_EQ(next, 2000u);
  EXPECT_EQ(contents.info.clock, "lockstep");
  EXPECT_EQ(contents.info.start_mode, "walk");
  EXPECT_NE(contents.info.config.find("sim"), std::string::npos);
  EXPECT_NE(contents.info.robot.urdf.find("<robot"), std::string::npos);
  EXPECT_EQ(contents.info.policy, shipped_policy_text());
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path()), 0);
  EXPECT_EQ(output(), "2000 ticks and 50 policy steps compared: every bit agrees\n");
}

TEST_F(RecordingTest, OfGo2WithItsOwnPolicyReplaysBitForBitAndIsDrawn) {
  record("--robot go2 --set dds.enabled=false");
  EXPECT_EQ(read_ticks(path(), [](const TickRecord&) { return true; }).info.policy,
            shipped_policy_text("go2"));
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path() + " --plot " + folder_.path("plots")), 0) << output();
  EXPECT_NE(output().find("every bit agrees"), std::string::npos) << output();
  EXPECT_NE(read_file(folder_.path("plots/run.html")).find("FL_calf"), std::string::npos);
}

TEST_F(RecordingTest, NamesAndReplaysTheRobotThatItCarries) {
  std::string map;
  {
    const TemporaryFolder robot;
    map = write_small_robot(robot);
    PolicyFile policy = random_policy_file();
    policy.spec.joint_names = sim::load_robot(map).description.joint_names;
    write_policy_file(robot.path("small.safetensors"), policy);
    run(SANDRUNNER_PROGRAM, "--start walk --duration 0.1 --robot " + map + " --policy " +
                                robot.path("small.safetensors") + " --record " + folder_.path(""));
    // Another robot beside it, under the same name, changes nothing.
    std::filesystem::remove(robot.path("small.urdf"));
    write_file(map, "no map");
    EXPECT_EQ(run(SANDRUNNER_REPLAY, path()), 0) << output();
  }
  McapReader reader(path());
  std::map<std::string, std::string> content;  // by topic
  while (const McapMessage* message = reader.next()) {
    content[reader.channels().at(message->channel_id).topic] = {
        reinterpret_cast<const char*>(message->data.data()), message->data.size()};
  }
  EXPECT_EQ(reader.attachments().back().data, small_robot_urdf());
  for (const char* leg : {"fl", "fr", "rl", "rr"}) {
    for (const char* joint : {"_roll", "_pitch", "_knee"}) {
      EXPECT_NE(content["/joint_states"].find(std::string(leg) + joint), std::string::npos);
    }
  }
  EXPECT_NE(content["/tf"].find("base_link"), std::string::npos);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path() + " --plot " + folder_.path("plots")), 0) << output();
  EXPECT_NE(output().find("every bit agrees"), std::string::npos) << output();
}

TEST_F(RecordingTest, ARobotThatIsNotAttachedWholeIsRefused) {
  record();
  const std::string broken = folder_.path("broken.mcap");
  const auto expect_refused = [&](const std::function<void(RecordingInfo&)>& change,
                                  const std::string& cause) {
    rewrite(path(), broken, change, {});
    EXPECT_EQ(run(SANDRUNNER_REPLAY, broken), 2) << output();
    EXPECT_NE(output().find("sandrunner-replay: " + broken + ": " + cause), std::string::npos)
        << output();
  };
  expect_refused([](RecordingInfo& info) { info.robot_map.clear(); },
                 "has no attachment 'robot.toml'");
  expect_refused([](RecordingInfo& info) { info.robot.urdf.clear(); },
                 "has no attachment 'robot.urdf'");
  expect_refused([](RecordingInfo& info) { info.robot_map = "name = 'x'"; },
                 "robot.toml: 'urdf' is missing");
  expect_refused([](RecordingInfo& info) { info.robot.urdf = small_robot_urdf(); },
                 "robot.urdf: has no link 'base'");
}

TEST_F(RecordingTest, FactsThatCannotBeAreRefused) {
  record();
  const std::string broken = folder_.path("broken.mcap");
  rewrite(path(), broken, [](RecordingInfo& info) { info.clock = "4000"; }, {});
  EXPECT_EQ(run(SANDRUNNER_REPLAY, broken), 2);
  EXPECT_NE(output().find("clock is '4000', expected lockstep or realtime"), std::string::npos)
      << output();
  rewrite(path(), broken, [](RecordingInfo& info) { info.start_mode = "fly"; }, {});
  EXPECT_EQ(run(SANDRUNNER_REPLAY, broken), 2);
  const auto facts = [](const std::string& first_tick) {
    return McapMetadata{kRunMetadata,
                        {{"build", "another"},
                         {"start_mode", "walk"},
                         {"clock", "lockstep"},
                         {"start_time_ns", "0"},
                         {"first_tick", first_tick}}};
  };
  {
    McapWriter writer(broken);
    writer.write_metadata(facts("0"));
    writer.write_message({.channel_id = writer.add_channel(0, kTicksTopic, "cdr", {}),
                          .sequence = 1,
                          .log_time_ns = 0,
                          .publish_time_ns = 0,
                          .data = CdrWriter().bytes()});
    writer.close();
  }
  EXPECT_EQ(run(SANDRUNNER_REPLAY, broken), 2) << output();
  EXPECT_EQ(output(),
            "sandrunner-replay: " + broken + ": the channel of /sandrunner/ticks has no schema\n");
  EXPECT_THROW(read_ticks(broken), InputError);
  {
    McapWriter writer(broken);
    writer.write_metadata(facts("x"));
    writer.close();
  }
  EXPECT_EQ(run(SANDRUNNER_REPLAY, broken), 2);
  EXPECT_NE(output().find("first_tick is 'x', expected a whole number"), std::string::npos);
}

TEST_F(RecordingTest, FlippedBitOfAnOutputIsNamed) {
  record();
  const std::size_t word = word_named("command_position_rad[4]");
  flip(path(), folder_.path("flipped.mcap"), 777, word, 1);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("flipped.mcap")), 1);
  EXPECT_NE(output().find("DIFFERS at tick 777 (0.19425 s): command_position_rad[4]: recorded"),
            std::string::npos)
      << output();
}

TEST_F(RecordingTest, ChangedSettingIsNamedAtItsFirstTick) {
  record();
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path() + " --set controller.walk.kd_nmsprad=0.6"), 1);
  EXPECT_NE(output().find("DIFFERS at tick 0 (0.00000 s): command_kd_nmsprad[0]: recorded 0.5"),
            std::string::npos)
      << output();
}

TEST_F(RecordingTest, RangeIsComparedAndDrawn) {
  record();
  EXPECT_EQ(run(SANDRUNNER_REPLAY,
                path() + " --from 0.1 --to 0.3 --plot '" + folder_.path("plots") + "'"),
            0)
      << output();
  EXPECT_NE(output().find("801 ticks"), std::string::npos) << output();
  EXPECT_TRUE(std::filesystem::exists(folder_.path("plots/run.csv")));
  EXPECT_TRUE(std::filesystem::exists(folder_.path("plots/run.html")));
}

TEST_F(RecordingTest, CutRecordingReadsUpToItsLastWholeChunk) {
  record();
  const std::string whole = read_file(path());
  write_file(folder_.path("cut.mcap"), whole.substr(0, whole.size() - whole.size() / 4));
  std::uint64_t ticks = 0;
  const RecordingContents contents =
      read_ticks(folder_.path("cut.mcap"), [&](const TickRecord& tick) {
        EXPECT_EQ(tick.input.sensors.tick, ticks);
        ++ticks;
        return true;
      });
  EXPECT_FALSE(contents.complete);
  EXPECT_GT(ticks, 100u);
  EXPECT_LT(ticks, 2000u);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("cut.mcap")), 2);
  EXPECT_EQ(output(), std::to_string(ticks) + " ticks and " +
                          std::to_string(ticks / kTicksPerPolicyStep) +
                          " policy steps compared: every bit agrees\nsandrunner-replay: " +
                          folder_.path("cut.mcap") +
                          ": the recording was cut, it is read up to its last chunk\n");
}

// ROS 2's player offers a topic as its channel says. RViz and tf2 ask for transient local here.
TEST_F(RecordingTest, TopicsThatComeOnceAreOfferedTransientLocal) {
  record();
  McapReader reader(path());
  while (reader.next()) {
  }
  int latched = 0;
  for (const auto& [id, channel] : reader.channels()) {
    const std::string profiles = channel.metadata.at("offered_qos_profiles");
    if (channel.topic != "/tf_static" && channel.topic != "/robot_description") {
      EXPECT_EQ(profiles, "") << channel.topic;
      continue;
    }
    ++latched;
    EXPECT_EQ(profiles.find("- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"), 0u);
    for (const char* key :
         {"deadline:\n    sec: ", "lifespan:\n    sec: ", "liveliness: 1\n",
          "liveliness_lease_duration:\n    sec: ", "avoid_ros_namespace_conventions: false"}) {
      EXPECT_NE(profiles.find(std::string("\n  ") + key), std::string::npos) << key;
    }
  }
  EXPECT_EQ(latched, 2);
}

TEST_F(RecordingTest, DamagedChunkCostsItsOwnSpanOnly) {
  ASSERT_EQ(
      run(SANDRUNNER_PROGRAM, "--start walk --duration 1 --record '" + folder_.path("") + "'"), 0);
  expect_damage_costs_its_own_span(path(), 4000);
}

TEST_F(RecordingTest, ManyChunksBeyondTheFileAreOneDamage) {
  record();
  std::string bytes = read_file(path());
  bytes.resize(bytes.size() / 2);
  for (int i = 0; i < 60000; ++i) bytes += head_of_a_chunk_beyond_the_file();
  write_file(folder_.path("many.mcap"), bytes);
  const RecordingContents contents = read_ticks(folder_.path("many.mcap"));
  EXPECT_FALSE(contents.complete);
  EXPECT_NE(contents.damage, "");
}

TEST_F(RecordingTest, DamagedLastChunkIsSaidToBeLostToTheEnd) {
  record();
  std::string bytes = read_file(path());
  bytes[chunks_of(bytes).back().first + 200] ^= 0x10;
  write_file(path(), bytes);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path()), 2);
  EXPECT_NE(output().find(" to the end\n"), std::string::npos) << output();
}

TEST_F(RecordingTest, NothingComparedIsNoSuccess) {
  record();
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path() + " --from 100"), 1);
  EXPECT_EQ(output(),
            "NOTHING COMPARED: the recording has none to compare in this range, it ends at 0.49975 "
            "s\n");
  const std::string bytes = read_file(path());
  write_file(path(), bytes.substr(0, chunks_of(bytes)[0].first + 100));
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path() + " --plot '" + folder_.path("plots") + "'"), 2);
  EXPECT_EQ(output(), "NOTHING COMPARED: the recording has no ticks\nsandrunner-replay: " + path() +
                          ": the recording was cut, it is read up to its last chunk\n");
  EXPECT_FALSE(std::filesystem::exists(folder_.path("plots")));
}

TEST_F(RecordingTest, FullDiskEndsTheRecordingAndNotTheRun) {
  EXPECT_EQ(run_on_full_disk(SANDRUNNER_PROGRAM,
                             "--start walk --duration 1 --record '" + folder_.path("") + "'"),
            2);
  EXPECT_NE(output().find("sandrunner: --record: the recording is cut: "), std::string::npos)
      << output();
  EXPECT_NE(output().find("finished on its feet"), std::string::npos) << output();
  EXPECT_NE(output().find("STOPPED"), std::string::npos) << output();
  // What was written can be read.
  EXPECT_FALSE(read_ticks(path()).complete);
}

TEST_F(RecordingTest, RunThatIsRefusedLeavesTheRecordingOfTheRunBefore) {
  record();
  const std::string before = read_file(path());
  EXPECT_EQ(run(SANDRUNNER_PROGRAM,
                "--clock realtime --command dds --set dds.interface=nosuch "
                "--record '" +
                    folder_.path("") + "'"),
            2)
      << output();
  EXPECT_EQ(read_file(path()), before);
  // Nor does one that ends before its first tick.
  Recorder(path(), {}, {}).finish();
  EXPECT_EQ(read_file(path()), before);
}

TEST_F(RecordingTest, LinkInPlaceOfTheRecordingIsRefusedAndNotFollowed) {
  const std::string victim = folder_.path("victim");
  write_file(victim, "precious");
  std::filesystem::create_symlink(victim, path());
  EXPECT_EQ(
      run(SANDRUNNER_PROGRAM, "--start walk --duration 0.1 --record '" + folder_.path("") + "'"),
      2);
  EXPECT_NE(output().find("run.mcap: cannot be written (it is a symbolic link)"), std::string::npos)
      << output();
  EXPECT_EQ(read_file(victim), "precious");
}

TEST_F(RecordingTest, FolderThatIsRemovedDuringTheRunIsReported) {
  const std::string gone = folder_.path("gone");
  ChildProcess robot({SANDRUNNER_PROGRAM, "--clock", "realtime", "--start", "walk", "--duration",
                      "2", "--record", gone});
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(gone + "/run.mcap"); }));
  std::filesystem::remove_all(gone);
  const Ended ended = robot.wait();
  EXPECT_NE(ended.code, 0);
  EXPECT_NE(ended.out.find("NOT RECORDED: " + gone + "/run.mcap was removed"), std::string::npos)
      << ended.out;
  EXPECT_EQ(ended.out.find("recorded "), std::string::npos) << ended.out;
}

TEST_F(RecordingTest, LimitOfTimeEndsTheRecording) {
  record("--set recording.limit_s=0.2");
  EXPECT_NE(output().find("its duration reached the limit"), std::string::npos) << output();
  const auto contents = read_ticks(path());
  EXPECT_TRUE(contents.complete);
  EXPECT_NEAR(static_cast<double>(contents.ticks), 800.0, 80.0);
}

TEST_F(RecordingTest, EventsAreModesRequestsAndFaults) {
  ASSERT_EQ(run(SANDRUNNER_PROGRAM, "--duration 0.5 --record '" + folder_.path("") + "'"), 0);
  McapReader reader(path());
  std::string events;
  while (const McapMessage* message = reader.next()) {
    if (reader.channels().at(message->channel_id).topic != kEventsTopic) continue;
    CdrReader cdr(message->data);
    cdr.number<std::uint64_t>();
    events += std::string(cdr.text()) + " ";
    events += std::string(cdr.text()) + "; ";
  }
  EXPECT_EQ(events,
            "mode passive; request arm; mode damping; mode stand_up; request stand; mode stand; "
            "mode walk; request walk; "
            "request stand; mode stand; request lie; mode damping; ");
}

// Every topic and field of the layout, e.g. "/odom.twist.twist.linear.x", exists in a recording.
TEST_F(RecordingTest, FoxgloveLayoutShowsWhatExists) {
  record();
  McapReader reader(path());
  std::map<std::string, std::string> schema_of;
  while (const McapMessage* message = reader.next()) {
    const McapChannel& channel = reader.channels().at(message->channel_id);
    schema_of[channel.topic] = reader.schemas().at(channel.schema_id).data;
  }
  const std::string layout = read_file(SANDRUNNER_FOXGLOVE_LAYOUT);
  ASSERT_TRUE(nlohmann::json::accept(layout));
  int shown = 0;
  for (const auto& match : matches_in(layout, "\"(/[a-z_/]+)([^\" ]*)\"")) {
    const std::string& topic = match[1];
    ASSERT_TRUE(schema_of.contains(topic)) << topic;
    for (const auto& field : matches_in(match[2], "[a-z_]+")) {
      EXPECT_NE(schema_of[topic].find(field[0]), std::string::npos)
          << topic << " has no " << field[0];
    }
    ++shown;
  }
  EXPECT_GE(shown, 12);
}

TEST_F(RecordingTest, TicksInAnotherLayoutAreRefusedInOneLine) {
  {
    McapWriter writer(path());
    writer.write_metadata({kRunMetadata,
                           {{"build", "another"},
                            {"start_mode", "walk"},
                            {"clock", "lockstep"},
                            {"start_time_ns", "0"},
                            {"first_tick", "0"}}});
    const std::uint16_t schema =
        writer.add_schema("sandrunner::TickBatch", "omgidl", "module sandrunner {};");
    writer.write_message({.channel_id = writer.add_channel(schema, kTicksTopic, "cdr", {}),
                          .sequence = 1,
                          .log_time_ns = 0,
                          .publish_time_ns = 0,
                          .data = CdrWriter().bytes()});
    writer.close();
  }
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path()), 2);
  EXPECT_EQ(output(),
            "sandrunner-replay: " + path() +
                ": found ticks in the layout of build 'another', expected this build's\n");
}

TEST_F(RecordingTest, FileThatIsNotARecordingIsBadInput) {
  write_file(folder_.path("none.mcap"), "not a recording");
  EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("none.mcap")), 2);
  const std::string line = output();
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
  EXPECT_EQ(run(SANDRUNNER_REPLAY, folder_.path("absent.mcap")), 2);
  EXPECT_EQ(run(SANDRUNNER_REPLAY, path() + " --from 3 --to 2"), 2);
}

}  // namespace
}  // namespace sandrunner
