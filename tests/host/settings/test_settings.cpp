// Settings: the table, YAML, assignments and presets, and what each says about bad input.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "host/core/error.h"
#include "host/settings/settings.h"
#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_settings {

using ::testing::HasSubstr;

TEST(Settings, YamlOfAllFieldsReadsBackEqual) {
  Settings changed;
  for (const char* assignment :
       {"volume.voxel_size=0.0125", "swarm.loss=absolute", "swarm.levels=64/9 32/4", "depth.max=3.5",
        "tracking.seed=77", "volume.colour=false", "swarm.max_iterations=7"})
    applyAssignment(changed, assignment);
  Settings read;
  applyYamlText(read, toYaml(changed), "test");
  EXPECT_EQ(toYaml(read), toYaml(changed));
  EXPECT_NE(toYaml(read), toYaml(Settings()));
  EXPECT_EQ(read.swarm.levels, (std::vector<SwarmLevel>{{64, 9}, {32, 4}}));
  EXPECT_EQ(read.swarm.loss, FitnessLoss::Absolute);
  EXPECT_DOUBLE_EQ(read.volume.voxel_size, 0.0125);
}

TEST(Settings, EveryFieldHasItsOwnKeyHelpAndPlace) {
  std::set<std::string> keys;
  for (const SettingsField& field : settingsTable()) {
    EXPECT_TRUE(keys.insert(field.key).second) << field.key;
    EXPECT_FALSE(field.help.empty()) << field.key;
    Settings defaults;
    setField(defaults, field.key, fieldText(Settings(), field), "test");  // the default is itself allowed
    EXPECT_EQ(toYaml(defaults), toYaml(Settings())) << field.key;
  }
}

TEST(Settings, AUserMeetsFewOfThemAndFirst) {
  const auto isForUsers = [](const SettingsField& field) { return !isExpertSetting(field.key); };
  const auto users = std::count_if(settingsTable().begin(), settingsTable().end(), isForUsers);
  EXPECT_LE(users, 60);
  EXPECT_GE(users, 20);
  const std::string yaml = toYaml(Settings());
  const auto heading = yaml.find("# For experts:", yaml.find("swarm:"));
  EXPECT_LT(yaml.find("max_iterations: 20"), heading);
  EXPECT_GT(yaml.find("first_axis_scale:"), heading);
  EXPECT_EQ(yaml.find("# For experts:", yaml.find("mesh:")), std::string::npos);
}

TEST(Settings, RenamedKeysAreAcceptedAndTold) {
  for (const RenamedSetting& renamed : renamedSettings()) {
    const std::string old_key(renamed.old_key), key(renamed.key);
    const auto row = std::find_if(settingsTable().begin(), settingsTable().end(),
                                  [&](const SettingsField& field) { return field.key == key; });
    ASSERT_NE(row, settingsTable().end()) << key << " is no setting";
    EXPECT_EQ(fieldText(Settings(), old_key, "test"), fieldText(Settings(), *row));
  }
  Settings settings;
  std::vector<std::string> told;
  const Log log = [&](Severity, const std::string& sentence) { told.push_back(sentence); };
  applyAssignment(settings, "tracker.method=icp", log);
  EXPECT_EQ(settings.tracking.method, TrackingMethod::Icp);
  applyYamlText(settings, "tracker:\n  method: pfo\n", "old.yaml", log);
  EXPECT_EQ(settings.tracking.method, TrackingMethod::Pfo);
  applyAssignment(settings, "tracking.method=pso", log);
  EXPECT_EQ(settings.tracking.method, TrackingMethod::Pso);
  const std::string sentence =
      ": 'tracker.method' is called 'tracking.method' now; the old name is still accepted.";
  EXPECT_THAT(told, ::testing::ElementsAre("--set" + sentence, "old.yaml" + sentence));
  EXPECT_NO_THROW(applyAssignment(settings, "tracker.method=pst")) << "without anyone to tell";
}

TEST(Settings, UnknownKeyNamesTheNearest) {
  Settings settings;
  EXPECT_THAT(inputErrorOf([&] { applyAssignment(settings, "volume.voxelsize=0.01"); }),
              HasSubstr("did you mean 'volume.voxel_size'"));
}

TEST(Settings, ValuesOutOfRangeNameKeyAndRange) {
  Settings settings;
  for (const char* bad :
       {"volume.voxel_size=0", "volume.voxel_size=nan", "volume.voxel_size=two", "swarm.max_iterations=2.5",
        "swarm.levels=64", "swarm.levels=", "swarm.loss=cubic", "volume.colour=perhaps"}) {
    const std::string key = std::string(bad).substr(0, std::string(bad).find('='));
    EXPECT_THAT(inputErrorOf([&] { applyAssignment(settings, bad); }), HasSubstr(key)) << bad;
  }
  EXPECT_EQ(toYaml(settings), toYaml(Settings())) << "a refused value must change nothing";
}

TEST(Settings, AssignmentWithoutEqualsIsExplained) {
  Settings settings;
  EXPECT_THAT(inputErrorOf([&] { applyAssignment(settings, "volume.voxel_size"); }), HasSubstr("key=value"));
}

TEST(Settings, PresetsLoadAndDiffer) {
  EXPECT_THAT(presetNames(), ::testing::ElementsAre("default", "paper"));
  for (const std::string& name : presetNames())
    EXPECT_NO_THROW(requireConsistent(loadSettings(name))) << name;
  EXPECT_EQ(loadSettings("paper").swarm.max_iterations, 20);
}

TEST(Settings, FileErrorsNameTheFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(inputErrorOf([&] { loadSettings((folder / "absent.yaml").string()); }),
              HasSubstr("absent.yaml"));
  const auto broken = folder.write("broken.yaml", "volume: [1, 2");
  EXPECT_THAT(inputErrorOf([&] { loadSettings(broken.string()); }), HasSubstr("broken.yaml"));
  const auto unknown = folder.write("unknown.yaml", "volume:\n  size: 4\n");
  EXPECT_THAT(inputErrorOf([&] { loadSettings(unknown.string()); }), HasSubstr("unknown.yaml"));
  const auto flat = folder.write("flat.yaml", "volume: 3\n");
  EXPECT_THAT(inputErrorOf([&] { loadSettings(flat.string()); }), HasSubstr("flat.yaml"));
}

TEST(Settings, CombinationsAreChecked) {
  Settings settings;
  settings.volume.truncation = settings.volume.voxel_size;
  EXPECT_THAT(inputErrorOf([&] { requireConsistent(settings); }), HasSubstr("volume.truncation"));
  settings = {};
  settings.depth.min = settings.depth.max;
  EXPECT_THAT(inputErrorOf([&] { requireConsistent(settings); }), HasSubstr("depth.min"));
}

}  // namespace test_settings
}  // namespace rosefusion::testing
