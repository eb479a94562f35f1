// Whole sequences: determinism, variety, and the folders they are written to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "host/core/error.h"
#include "host/export/mesh_io.h"
#include "host/synth/shapes.h"
#include "host/synth/tum_writer.h"
#include "tests/host/synth/small_options.h"

namespace rosefusion::testing {
namespace test_sequence {

namespace fs = std::filesystem;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(Sequence, SameSeedSameBytesOnAnyNumberOfThreads) {
  SynthOptions options = smallOptions(5, 20);
  options.colour = true;
  options.threads = 1;
  const SynthSequence one = makeSequence(options);
  options.threads = 3;
  const SynthSequence three = makeSequence(options);
  ASSERT_EQ(one.frames.size(), 20u);
  ASSERT_EQ(three.frames.size(), 20u);
  for (std::size_t i = 0; i < one.frames.size(); ++i) {
    EXPECT_TRUE(same(one.frames[i].depth, three.frames[i].depth));
    EXPECT_TRUE(same(one.frames[i].colour, three.frames[i].colour));
    EXPECT_EQ(one.frames[i].timestamp, one.truth[i].timestamp);
    EXPECT_TRUE(one.truth[i].world_from_camera.matrix() == three.truth[i].world_from_camera.matrix());
  }
  EXPECT_TRUE(one.mesh.vertices == three.mesh.vertices);
}

TEST(Sequence, OtherSeedsGiveOtherRoomsOfSensibleSize) {
  std::vector<Eigen::Vector3f> sizes;
  for (int seed = 1; seed <= 12; ++seed) {
    const Scene room = makeRoom(seed);
    Eigen::Vector3f low = room.mesh.vertices[0], high = low;
    for (const auto& v : room.mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    const Eigen::Vector3f size = high - low;
    EXPECT_GE(size.x(), 4.0f);
    EXPECT_LE(size.x(), 7.7f);  // window recesses reach 0.32 m out on either side
    EXPECT_GE(size.y(), 3.5f);
    EXPECT_LE(size.y(), 6.7f);
    EXPECT_GE(size.z(), 2.5f);
    EXPECT_LE(size.z(), 3.0f);
    EXPECT_GT(room.mesh.triangles.size(), 30000u);
    EXPECT_EQ(room.face_material.size(), room.mesh.triangles.size());
    for (const auto& other : sizes) EXPECT_GT((other - size).norm(), 1e-3f);
    sizes.push_back(size);
  }
}

TEST(Sequence, SimkinectsNoiseReadsNearer) {
  SynthOptions options = smallOptions(5, 2);
  const SynthPlan handa(options);
  options.noise = DepthNoise::Simkinect;
  const SynthPlan simkinect(options);
  EXPECT_LT(cv::mean(simkinect.renderFrame(0).depth)[0], cv::mean(handa.renderFrame(0).depth)[0]);
  EXPECT_EQ(nlohmann::json::parse(synthReport(handa)).at("noise"), "handa");
  EXPECT_EQ(nlohmann::json::parse(synthReport(simkinect)).at("noise"), "simkinect");
  for (const char* word : {"none", "handa", "simkinect"}) EXPECT_STREQ(toString(depthNoiseFrom(word)), word);
  EXPECT_THROW(depthNoiseFrom("kinect"), InputError);
}

TEST(Sequence, NoiseCanBeTurnedOff) {
  SynthOptions options = smallOptions(5, 3);
  const SynthSequence noisy = makeSequence(options);
  options.noise = DepthNoise::None;
  const SynthSequence clean = makeSequence(options);
  EXPECT_FALSE(same(noisy.frames[1].depth, clean.frames[1].depth));
  EXPECT_TRUE(noisy.truth[1].world_from_camera.matrix() == clean.truth[1].world_from_camera.matrix());
  EXPECT_TRUE(clean.frames[1].colour.empty());
}

TEST(Sequence, ColourDoesNotChangeTheDepth) {
  SynthOptions options = smallOptions(5, 3);
  const SynthSequence without = makeSequence(options);
  options.colour = true;
  const SynthSequence with = makeSequence(options);
  for (int i = 0; i < 3; ++i)
    EXPECT_TRUE(same(with.frames[i].depth, without.frames[i].depth)) << "frame " << i;
}

class Folder : public ::testing::Test {
 protected:
  Folder()
      : root_(fs::path(::testing::TempDir()) /
              (std::string("synth_") + ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  ~Folder() override { fs::remove_all(root_); }

  std::string complaintFor(const fs::path& out, bool force = false) const {
    try {
      requireUsableOutput(out, force);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  fs::path root_;
};

std::vector<std::pair<double, std::string>> readIndex(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::pair<double, std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    double stamp;
    std::string name;
    EXPECT_TRUE(fields >> stamp >> name) << line;
    rows.emplace_back(stamp, name);
  }
  return rows;
}

TEST_F(Folder, HoldsWhatATumReaderExpects) {
  SynthOptions options = smallOptions(4, 12);
  options.colour = true;
  const SynthPlan plan(options);
  int calls = 0, last_total = 0;
  writeTumSequence(root_ / "out", plan, false, [&](int, int total) {
    ++calls;
    last_total = total;
  });
  EXPECT_EQ(calls, 12);
  EXPECT_EQ(last_total, 12);
  const Trajectory truth = readTumTrajectory(root_ / "out" / "groundtruth.txt");
  const auto depth = readIndex(root_ / "out" / "depth.txt"), rgb = readIndex(root_ / "out" / "rgb.txt");
  ASSERT_EQ(truth.size(), 12u);
  ASSERT_EQ(depth.size(), 12u);
  ASSERT_EQ(rgb.size(), 12u);
  for (int i = 0; i < 12; ++i) {
    EXPECT_NEAR(depth[i].first, i / 30.0, 1e-6);
    EXPECT_EQ(depth[i].first, rgb[i].first);
    EXPECT_EQ(depth[i].first, truth[i].timestamp);
    EXPECT_LT((truth[i].world_from_camera.matrix() - plan.truth()[i].world_from_camera.matrix()).norm(),
              1e-7);
    const cv::Mat image = cv::imread((root_ / "out" / depth[i].second).string(), cv::IMREAD_UNCHANGED);
    EXPECT_TRUE(same(image, plan.renderFrame(i).depth));
    EXPECT_EQ(image.type(), CV_16UC1);
    const cv::Mat colour = cv::imread((root_ / "out" / rgb[i].second).string(), cv::IMREAD_UNCHANGED);
    EXPECT_TRUE(same(colour, plan.renderFrame(i).colour));
  }
  double k[4];
  std::ifstream calibration(root_ / "out" / "calibration.txt");
  for (double& value : k) calibration >> value;
  EXPECT_THAT(k, ::testing::ElementsAre(40, 40, 39.5, 29.5));
  const TriangleMesh whole = readMesh(root_ / "out" / "mesh.ply"),
                     seen = readMesh(root_ / "out" / "mesh_seen.ply");
  EXPECT_EQ(whole.colours.size(), whole.vertices.size());
  EXPECT_LT(seen.triangles.size(), whole.triangles.size());
  const auto report = nlohmann::json::parse(std::ifstream(root_ / "out" / "synth.json"));
  EXPECT_EQ(report.at("seed"), 4);
  EXPECT_EQ(report.at("frames"), 12);
  EXPECT_NEAR(report.at("true_motion").at("linear_mean_mps").get<double>(), plan.statistics().linear_mean,
              1e-12);
  EXPECT_FALSE(fs::exists(root_ / "out.part"));
}

TEST_F(Folder, DepthPngsAreMetresTimes5000) {
  SynthOptions options = smallOptions(4, 2);
  options.noise = DepthNoise::None;
  const SynthPlan plan(options);
  const cv::Mat depth = plan.renderFrame(0).depth;
  const Pose& pose = plan.truth()[0].world_from_camera;
  const auto hit =
      plan.tracer().cast(pose.translation(), pose.linear() * options.intrinsics.unproject(11, 33, 1), 10);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(depth.at<std::uint16_t>(33, 11) / 5000.0, hit->distance, 0.00011);
}

TEST_F(Folder, OnlyEmptyOnesAndSequencesAreReplaced) {
  using ::testing::HasSubstr;
  const SynthPlan plan(smallOptions(4, 2));
  writeTumSequence(root_ / "out", plan, false);
  EXPECT_THAT(complaintFor(root_ / "out"), HasSubstr("--force"));
  EXPECT_EQ(complaintFor(root_ / "out", true), "");
  std::ofstream(root_ / "out" / "depth" / "old.png") << "x";
  writeTumSequence(root_ / "out/", plan, true);
  EXPECT_FALSE(fs::exists(root_ / "out" / "depth" / "old.png"));

  fs::create_directories(root_ / "papers");
  std::ofstream(root_ / "papers" / "thesis.txt") << "x";
  EXPECT_THAT(complaintFor(root_ / "papers", true), HasSubstr("papers"));
  EXPECT_THROW(writeTumSequence(root_ / "papers", plan, true), InputError);
  EXPECT_TRUE(fs::exists(root_ / "papers" / "thesis.txt"));
  EXPECT_THAT(complaintFor(root_ / "papers" / "thesis.txt"), HasSubstr("is a file"));
}

TEST_F(Folder, WhatOnlyLooksLikeALeftoverIsKept) {
  fs::create_directories(root_ / "out.part");
  std::ofstream(root_ / "out.part" / "thesis.txt") << "x";
  EXPECT_NE(complaintFor(root_ / "out").find("out.part"), std::string::npos);
  EXPECT_THROW(writeTumSequence(root_ / "out", SynthPlan(smallOptions(1, 4)), false), InputError);
  EXPECT_TRUE(fs::exists(root_ / "out.part" / "thesis.txt"));
  EXPECT_NE(complaintFor(""), "");
}

TEST_F(Folder, WhatAKilledRunLeftIsReplaced) {
  const SynthPlan plan(smallOptions(2, 4));
  fs::create_directories(root_ / "out.part" / "depth");
  std::ofstream(root_ / "out.part" / ".rosefusion-part") << "";
  EXPECT_EQ(complaintFor(root_ / "out"), "");
  fs::remove_all(root_ / "out.part");
  fs::create_directories(root_ / "out.part");  // before it was marked
  std::ofstream(root_ / "out.part" / ".rosefusion-part.part") << "";
  fs::create_directories(root_ / "out.replaced.part" / "sequence");  // and between an old name and a new one
  std::ofstream(root_ / "out.replaced.part" / ".rosefusion-part") << "";
  writeTumSequence(root_ / "out", plan, false);
  EXPECT_TRUE(fs::exists(root_ / "out" / "synth.json"));
  EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);
  EXPECT_FALSE(fs::exists(root_ / "out" / ".rosefusion-part"));
}

TEST_F(Folder, LeavesNothingBehindWhenWritingFails) {
  const SynthPlan plan(smallOptions(4, 4));
  std::ofstream(root_ / "file") << "x";
  EXPECT_THROW(writeTumSequence(root_ / "file" / "out", plan, false), InputError);
  EXPECT_THROW(writeTumSequence(root_ / "out", plan, false,
                                [](int done, int) {
                                  if (done == 3) throw InputError("disk full");
                                }),
               InputError);
  EXPECT_FALSE(fs::exists(root_ / "out"));
  EXPECT_FALSE(fs::exists(root_ / "out.part"));
}

/// An empty room of 5 x 2.6 x 4 m, y up, as a file.
fs::path writeBoxRoom(const fs::path& file, float scale) {
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  shapes.box(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(5, 2.6, 4), shapes.addMaterial({}));
  for (Eigen::Vector3f& v : scene.mesh.vertices) v *= scale;
  writePly(file, scene.mesh);
  return file;
}

TEST_F(Folder, MeshesWithAnotherUpAxisKeepTheirFrame) {
  SynthOptions options = smallOptions(4, 30);
  options.mesh_file = writeBoxRoom(root_ / "room.ply", 1);
  const SynthPlan plan(options);
  EXPECT_EQ(plan.scene().up, Eigen::Vector3d::UnitY());
  for (const StampedPose& p : plan.truth()) {
    EXPECT_GT(p.world_from_camera.translation().y(), 0.6);
    EXPECT_LT(p.world_from_camera.translation().y(), 2.0);
    EXPECT_LT(p.world_from_camera.linear()(1, 1), -0.5);
  }
}

TEST_F(Folder, MeshesThatAreNoRoomsAreRefused) {
  using ::testing::HasSubstr;
  const auto complaint = [&](const fs::path& file) -> std::string {
    SynthOptions options = smallOptions(4, 30);
    options.mesh_file = file;
    try {
      SynthPlan plan(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(complaint(writeBoxRoom(root_ / "millimetres.ply", 1000)), HasSubstr("scale it to metres"));
  std::ofstream(root_ / "empty.ply")
      << "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
         "property float z\nelement face 0\n"
         "property list uchar int vertex_indices\nend_header\n";
  EXPECT_THAT(complaint(root_ / "empty.ply"), HasSubstr("empty.ply"));
  // A table top in the open: nothing encloses the camera.
  Scene scene;
  const ShapeBuilder shapes(scene, Eigen::Isometry3d::Identity());
  shapes.box(Eigen::Vector3d(4, 4, 1), shapes.addMaterial({}));
  shapes.at({0, 0, 3}).box(Eigen::Vector3d(0.5, 0.5, 0.5), 0);
  writePly(root_ / "open.ply", scene.mesh);
  EXPECT_THAT(complaint(root_ / "open.ply"), HasSubstr("no free space"));
}

}  // namespace test_sequence
}  // namespace rosefusion::testing
