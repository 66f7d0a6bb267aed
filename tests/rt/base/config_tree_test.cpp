// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/config_tree.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

#include "tests/support/error_of.h"
#include "tests/support/not_finite.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

ConfigTree from(const std::string& toml, const std::string& origin = "a.toml") {
  ConfigTree config;
  config.add_text(toml, origin);
  return config;
}

std::string number_error(const std::string& value, double min, double max) {
  ConfigTree config = from("\n[terrain]\nfriction = " + value);
  return error_of([&] { config.number("terrain.friction", 0.0, min, max); });
}

TEST(ConfigTreeTest, StrongestLayerWinsKeyByKey) {
  ConfigTree config = from("[terrain]\nkind = 'granular'\nfriction = 0.8\nsigma = 1e6", "preset");
  config.add_text("terrain.friction = 0.7\nterrain.sigma = 2_000_000", "file");
  config.set("terrain.friction=0.6");
  EXPECT_EQ(config.text("terrain.kind", ""), "granular");
  EXPECT_EQ(config.number("terrain.sigma", 0.0, 0.0, kInf), 2e6);
  EXPECT_EQ(config.number("terrain.friction", 0.0, 0.0, 1.0), 0.6);
  EXPECT_EQ(config.number("terrain.absent", -5.0, 0.0, 1.0), -5.0);
  EXPECT_TRUE(config.has("terrain.kind"));
  EXPECT_TRUE(config.has("terrain"));
  EXPECT_FALSE(config.has("terrain.absent"));
  EXPECT_FALSE(config.has("terrain.kind.deeper"));
}

TEST(ConfigTreeTest, ReadsEveryType) {
  ConfigTree config = from(
      "n = -3\nbig = 9007199254740993\nyes = true\nname = 'a \"b\"'\nmode = 'walk'\n"
      "v = [1, 2.5, -3]");
  EXPECT_EQ(config.integer("n", 0, -3, -3), -3);
  EXPECT_EQ(config.integer("big", 0, 0, std::numeric_limits<std::int64_t>::max()),
            9007199254740993);
  EXPECT_TRUE(config.flag("yes", false));
  EXPECT_TRUE(config.flag("absent_flag", true));
  EXPECT_EQ(config.text("name", ""), "a \"b\"");
  EXPECT_EQ(config.choice("mode", "stand", {"stand", "walk"}), "walk");
  EXPECT_EQ(config.choice("absent_mode", "stand", {"stand", "walk"}), "stand");
  EXPECT_EQ(config.numbers("v", {}, 3, -3.0, 2.5), (std::vector<double>{1.0, 2.5, -3.0}));
  EXPECT_EQ(config.numbers("v", {}, ConfigTree::kAnySize, -kInf, kInf).size(), 3U);
  EXPECT_EQ(config.numbers("absent_v", {7.0}, 3, 0.0, 1.0), (std::vector<double>{7.0}));
}

TEST(ConfigTreeTest, NumbersThatRepeatMayBeGivenOnce) {
  ConfigTree config = from("one = 2\nall = [1, 2, 3]\nfew = [1, 2]\nmany = [1, 2, 3, 4]");
  const auto read = [&](const char* key, std::size_t size, std::size_t few) {
    return config.repeated(key, std::vector<double>(size, 7.0), few, 0.0, 9.0);
  };
  EXPECT_EQ(read("one", 3, 1), (std::vector<double>{2, 2, 2}));
  EXPECT_EQ(read("all", 3, 1), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(read("few", 4, 2), (std::vector<double>{1, 2, 1, 2}));
  EXPECT_EQ(read("many", 4, 2), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(read("absent", 3, 1), (std::vector<double>{7, 7, 7}));
  EXPECT_EQ(config.effective(),
            "absent = 7.0\nall = [1.0, 2.0, 3.0]\nfew = [1.0, 2.0]\n"
            "many = [1.0, 2.0, 3.0, 4.0]\none = 2.0\n");
  EXPECT_EQ(error_of([&] { read("few", 3, 1); }),
            "a.toml:3: few: found an array of 2, expected a finite number from 0 to 9, or an array "
            "of 3");
  EXPECT_EQ(error_of([&] { read("one", 4, 2); }),
            "a.toml:1: one: found 2, expected an array of 2 finite numbers from 0 to 9, or of 4");
  EXPECT_EQ(error_of([&] { config.repeated("all", {0.0, 0.0, 0.0}, 1, 0.0, 2.0); }),
            "a.toml:2: all[2]: found 3, expected a finite number from 0 to 2, or an array of 3");
}

TEST(ConfigTreeTest, RefusesNumbersOutOfRangeNotFiniteOrOfOtherType) {
  EXPECT_EQ(number_error("-0.5", 0.0, 1.0),
            "a.toml:3: terrain.friction: found -0.5, expected a finite number from 0 to 1");
  EXPECT_EQ(number_error("2", 0.0, 1.0),
            "a.toml:3: terrain.friction: found 2, expected a finite number from 0 to 1");
  EXPECT_EQ(number_error("nan", -kInf, kInf),
            "a.toml:3: terrain.friction: found nan, expected a finite number");
  EXPECT_EQ(number_error("inf", 0.0, kInf),
            "a.toml:3: terrain.friction: found inf, expected a finite number of at least 0");
  EXPECT_EQ(number_error("'0.5'", -kInf, 1.0),
            "a.toml:3: terrain.friction: found \"0.5\", expected a finite number of at most 1");
  EXPECT_EQ(number_error("true", -kInf, kInf),
            "a.toml:3: terrain.friction: found true, expected a finite number");
  EXPECT_EQ(number_error("{x = 1}", -kInf, kInf),
            "a.toml:3: terrain.friction: found a table, expected a finite number");
  EXPECT_EQ(number_error("2026-01-01", -kInf, kInf),
            "a.toml:3: terrain.friction: found a date or time, expected a finite number");
}

TEST(ConfigTreeTest, RefusesOtherTypesThanAskedFor) {
  ConfigTree config = from("a = 1.5\nb = \"x\\ny\"\nv = [1, nan]\nt = [1]");
  EXPECT_EQ(error_of([&] { config.integer("a", 0, 0, 9); }),
            "a.toml:1: a: found 1.5, expected a whole number from 0 to 9");
  EXPECT_EQ(error_of([&] { config.flag("a", true); }),
            "a.toml:1: a: found 1.5, expected true or false");
  EXPECT_EQ(error_of([&] { config.text("a", ""); }), "a.toml:1: a: found 1.5, expected a string");
  EXPECT_EQ(error_of([&] { config.choice("b", "u", {"u", "v"}); }),
            "a.toml:2: b: found \"x\\ny\", expected one of \"u\", \"v\"");
  EXPECT_EQ(
      error_of([&] { config.numbers("v", {}, 3, 0.0, kInf); }),
      "a.toml:3: v: found an array of 2, expected an array of 3 finite numbers of at least 0");
  EXPECT_EQ(error_of([&] { config.numbers("v", {}, 2, -kInf, kInf); }),
            "a.toml:3: v[1]: found nan, expected an array of 2 finite numbers");
  EXPECT_EQ(error_of([&] { config.tables("t"); }),
            "a.toml:4: t: found 1, expected an array of tables");
  EXPECT_EQ(error_of([&] { config.tables("a"); }),
            "a.toml:1: a: found 1.5, expected an array of tables");
}

TEST(ConfigTreeTest, SetTakesTomlValuesAndBareWords) {
  ConfigTree config;
  config.set("a.count=3");
  config.set("a.on=false");
  config.set("a.v=[1, 2]");
  config.set("a.preset=dry-sand");
  config.set("a.file=runs/a.b_c.csv");
  config.set("a.quoted=\"two words\"");
  config.set("a.segments=[{x = 1}, {x = 2}]");
  EXPECT_EQ(config.integer("a.count", 0, 0, 9), 3);
  EXPECT_FALSE(config.flag("a.on", true));
  EXPECT_EQ(config.numbers("a.v", {}, 2, 0.0, 9.0), (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(config.text("a.preset", ""), "dry-sand");
  EXPECT_EQ(config.text("a.file", ""), "runs/a.b_c.csv");
  EXPECT_EQ(config.text("a.quoted", ""), "two words");
  std::vector<ConfigTree> segments = config.tables("a.segments");
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_EQ(segments[1].number("x", 0.0, 0.0, 9.0), 2.0);
  EXPECT_EQ(error_of([&] { segments[0].number("x", 0.0, 5.0, 9.0); }),
            "--set: a.segments[0].x: found 1, expected a finite number from 5 to 9");
  EXPECT_EQ(error_of([&] { config.number("a.preset", 0.0, 0.0, 1.0); }),
            "--set: a.preset: found \"dry-sand\", expected a finite number from 0 to 1");
}

TEST(ConfigTreeTest, SetTextTakesAnyText) {
  for (const char* text :
       {"", "robot keys", "2024", "a\"b\\c", "tab\there\nand there", "Schlüssel"}) {
    ConfigTree config;
    config.set_text("dds.dir", text, "--dir");
    EXPECT_EQ(config.text("dds.dir", "none"), text);
  }
  ConfigTree config;
  EXPECT_EQ(error_of([&] { config.set_text("dds.dir", "\xff", "--dir"); }).substr(0, 5), "--dir");
}

TEST(ConfigTreeTest, SetRefusesTextThatIsNotAnAssignment) {
  ConfigTree config;
  for (const char* bad : {"", "a", "=1", "a.=1", ".a=1", "a..b=1", "a b=1", "a[0]=1", "a=",
                          "a=two words", "a=[1", "a='x", "a=1\nb=2", "a=1\rb=2", "a={x=1}}"}) {
    EXPECT_EQ(error_of([&] { config.set(bad); }).substr(0, 5), "--set") << bad;
  }
  EXPECT_EQ(
      error_of([&] { config.set("a=two words"); }),
      "--set: a: found 'two words', expected a TOML value (strings in quotes unless one word)");
  EXPECT_EQ(error_of([&] { config.set("a..b=1"); }).substr(0, 20), "--set: not valid TOM");
  config.reject_unknown();  // nothing of it was added
}

TEST(ConfigTreeTest, UnknownKeyIsNamedWithItsLineAndTheLikelyOne) {
  ConfigTree config = from("[terrain]\nfriction = 0.8\n", "preset");
  config.add_text("\n[terrain]\nzeta_x = 1\nfricton = 0.7\n", "b.toml");
  config.number("terrain.friction", 0.0, 0.0, 1.0);
  config.number("controller.zeta", 0.0, 0.0, 1.0);
  EXPECT_EQ(error_of([&] { config.reject_unknown(); }), "b.toml:3: unknown key 'terrain.zeta_x'");
  config.number("terrain.zeta_x", 0.0, 0.0, 1.0);
  EXPECT_EQ(error_of([&] { config.reject_unknown(); }),
            "b.toml:4: unknown key 'terrain.fricton', did you mean 'terrain.friction'?");
  config.number("terrain.fricton", 0.0, 0.0, 1.0);
  config.reject_unknown();
}

TEST(ConfigTreeTest, UnknownKeyHintFindsTheRightTable) {
  ConfigTree config;
  config.set("sigma_flat=1");
  config.number("terrain.granular.sigma_flat", 0.0, 0.0, 1.0);
  EXPECT_EQ(error_of([&] { config.reject_unknown(); }),
            "--set: unknown key 'sigma_flat', did you mean "
            "'terrain.granular.sigma_flat'?");
}

TEST(ConfigTreeTest, UnknownTablesAndValuesInPlaceOfTablesAreRefused) {
  ConfigTree empty = from("[nothing]\n");
  EXPECT_EQ(error_of([&] { empty.reject_unknown(); }), "a.toml:1: unknown key 'nothing'");
  ConfigTree array = from("[[thing]]\nx = 1\n");
  EXPECT_EQ(error_of([&] { array.reject_unknown(); }), "a.toml:1: unknown key 'thing'");
  ConfigTree value = from("terrain = 5\n");
  value.number("terrain.friction", 0.0, 0.0, 1.0);
  EXPECT_EQ(error_of([&] { value.reject_unknown(); }),
            "a.toml:1: terrain: found 5, expected a table");
  ConfigTree quoted = from("'terrain.friction' = 0.5\n");
  quoted.number("terrain.friction", 0.0, 0.0, 1.0);
  EXPECT_EQ(error_of([&] { quoted.reject_unknown(); }).find("a.toml:1: unknown key '\""), 0U);
  ConfigTree known_empty = from("[terrain]\n");
  known_empty.number("terrain.friction", 0.0, 0.0, 1.0);
  known_empty.reject_unknown();
}

TEST(ConfigTreeTest, ArraysOfTablesComeWholeFromTheStrongestLayer) {
  ConfigTree config = from("[[segment]]\nx = 1\nold = 1\n[[segment]]\nx = 2\n", "weak");
  config.add_text("[[segment]]\nx = 3\n\n[[segment.layer]]\ndepth = 0.1\ndepht = 0.2\n", "strong");
  std::vector<ConfigTree> segments = config.tables("segment");
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(segments[0].number("x", 0.0, 0.0, 9.0), 3.0);
  EXPECT_EQ(error_of([&] { config.reject_unknown(); }), "strong:4: unknown key 'segment[0].layer'");
  std::vector<ConfigTree> layers = segments[0].tables("layer");
  ASSERT_EQ(layers.size(), 1U);
  EXPECT_EQ(layers[0].number("depth", 0.0, 0.0, 9.0), 0.1);
  const std::string expected =
      "strong:6: unknown key 'segment[0].layer[0].depht', did you mean "
      "'segment[0].layer[0].depth'?";
  EXPECT_EQ(error_of([&] { config.reject_unknown(); }), expected);
  EXPECT_EQ(error_of([&] { segments[0].reject_unknown(); }), expected);
  layers[0].number("depht", 0.0, 0.0, 9.0);
  config.reject_unknown();
  EXPECT_TRUE(config.tables("absent").empty());
}

TEST(ConfigTreeTest, ElementsOutliveTheTree) {
  std::vector<ConfigTree> segments;
  {
    ConfigTree config = from("[[segment]]\nx = 1\n");
    segments = config.tables("segment");
  }
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(segments[0].number("x", 0.0, 0.0, 9.0), 1.0);
}

/// Asks a tree for one value of each kind.
void ask_all(ConfigTree& config) {
  config.number("b.tenth", 0.1, 0.0, 1.0);
  config.number("b.big", 1e6, 0.0, kInf);
  config.number("b.none", kNan, 0.0, 1.0);
  config.integer("a.count", 4, 0, 9);
  config.flag("a.on", true);
  config.text("name", "x\ty \xce\xbc");
  config.numbers("v", {1.0, 0.2}, ConfigTree::kAnySize, 0.0, 9.0);
  for (ConfigTree& segment : config.tables("segment")) {
    segment.number("x_m", 0.0, 0.0, 9.0);
    segment.text("soil.kind", "sand");
  }
  config.tables("none");
}

TEST(ConfigTreeTest, SettingsInEffectiveTextAreItsKeysAndValues) {
  ConfigTree config = from("v = [1, 2]\na.name = \"x = y\"\n");
  config.numbers("v", {}, 2, 0.0, 9.0);
  config.text("a.name", "");
  EXPECT_EQ(settings_in(config.effective()),
            (std::map<std::string, std::string>{{"a.name", "\"x = y\""}, {"v", "[1.0, 2.0]"}}));
  EXPECT_TRUE(settings_in("").empty());
}

TEST(ConfigTreeTest, EffectiveTextGivesTheSameConfigurationAgain) {
  ConfigTree config = from("a.count = 7\nignored = 1\n[[segment]]\nx_m = 2\n[[segment]]\n");
  ask_all(config);
  const std::string text = config.effective();
  EXPECT_EQ(text,
            "a.count = 7\n"
            "a.on = true\n"
            "b.big = 1000000.0\n"
            "b.tenth = 0.1\n"
            "name = \"x\\ty \xce\xbc\"\n"
            "none = []\n"
            "segment = [\n"
            "  {soil.kind = \"sand\", x_m = 2.0},\n"
            "  {soil.kind = \"sand\", x_m = 0.0},\n"
            "]\n"
            "v = [1.0, 0.2]\n");
  ConfigTree again = from(text, "effective");
  ask_all(again);
  again.reject_unknown();
  EXPECT_EQ(again.effective(), text);
}

TEST(ConfigTreeTest, FilesThatCannotBeUsedAreNamedWithTheLine) {
  const TemporaryFolder folder;
  const std::string path = folder.path("test.toml");
  ConfigTree config;
  std::ofstream(path) << "a = 1\nb = = 2\n";
  EXPECT_EQ(error_of([&] { config.add_file(path); }).find(path + ":2: not valid TOML: "), 0U);
  std::ofstream(path) << "a = 1\na = 2\n";
  EXPECT_EQ(error_of([&] { config.add_file(path); }).find(path + ":2: not valid TOML: "), 0U);
  std::ofstream(path) << "a = 1\n";
  config.add_file(path);
  EXPECT_EQ(config.integer("a", 0, 0, 1), 1);
  EXPECT_EQ(error_of([&] { config.integer("a", 0, 5, 6); }),
            path + ":1: a: found 1, expected a whole number from 5 to 6");
  std::remove(path.c_str());
  EXPECT_EQ(error_of([&] { config.add_file(path); }),
            path + ": cannot be read (No such file or directory), expected a TOML file");
  EXPECT_EQ(error_of([&] { config.add_file(folder.path("")); }).find(folder.path("")), 0U);
}

TEST(ConfigTreeTest, KeysOfTooManyPartsAreRefused) {
  std::string key = "a";
  for (int i = 1; i < 40'000; ++i) key += ".a";
  const std::string cause = "a key has more than 32 parts";
  EXPECT_EQ(error_of([&] { from("b = 1\n" + key + " = 1\n"); }), "a.toml:2: " + cause);
  EXPECT_EQ(error_of([&] { from("[" + key + "]\n"); }), "a.toml:1: " + cause);
  EXPECT_EQ(error_of([&] { from("t = {b = 1, " + key + " = 1}"); }), "a.toml:1: " + cause);
  EXPECT_EQ(error_of([&] { from("s = \"\"\"\n\"\"\"\n'x'." + key + " = 1"); }),
            "a.toml:3: " + cause);
  EXPECT_EQ(error_of([&] { from("s = [\"\"\"y\"\"\"\", {" + key + " = 1}]"); }),
            "a.toml:1: " + cause)
      << "a quote of the string's own before its end";
  EXPECT_NE(error_of([&] { ConfigTree().set(key + "=1"); }).find(cause), std::string::npos);
}

TEST(ConfigTreeTest, ValuesNestedTooDeepAreRefused) {
  const std::string cause = "values are nested more than 32 deep";
  EXPECT_EQ(error_of([&] { from("a = [1]\nb = " + std::string(33, '[')); }), "a.toml:2: " + cause);
  std::string tables;
  for (int i = 0; i < 33; ++i) tables += "{a = ";
  EXPECT_EQ(error_of([&] { from("b = " + tables); }), "a.toml:1: " + cause);
  from("b = " + std::string(32, '[') + std::string(32, ']'));
}

TEST(ConfigTreeTest, DotsThatJoinNoKeysAreNotCounted) {
  const std::string dots(100, '.');
  ConfigTree config = from("# " + dots + "\ns = \"\\\"" + dots + "\"\nl = '" + dots +
                           "'\nt = \"\"\"\n\"" + dots + "\"\"\"\nv = [" +
                           [] {
                             std::string numbers;
                             for (int i = 0; i < 100; ++i) numbers += "1.5, ";
                             return numbers;
                           }() +
                           "]\n");
  EXPECT_EQ(config.text("s", ""), "\"" + dots);
  EXPECT_EQ(config.text("l", ""), dots);
  EXPECT_EQ(config.numbers("v", {}, 100, 0.0, 2.0).size(), 100u);
}

}  // namespace
}  // namespace sandrunner
