#include "host/evaluation/mesh_error.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "host/evaluation/report_json.h"
#include "tests/host/core/temporary_folder.h"
#include "tests/host/evaluation/trajectories.h"

namespace rosefusion::testing {
namespace test_mesh_error {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The rectangle 0..width x 0..height at the given z, two triangles.
TriangleMesh rectangle(float width, float height, float z) {
  return {{{0, 0, z}, {width, 0, z}, {width, height, z}, {0, height, z}}, {}, {}, {{0, 1, 2}, {0, 2, 3}}};
}

const MeshErrorOptions kOptions{.samples = 20000};
// Four standard errors of a share of one half over 20000 samples.
constexpr double kShareTolerance = 4 * 0.5 / 141;

TEST(MeshError, SameSurfaceHasNone) {
  const MeshErrors e = measureMesh(rectangle(2, 3, 1), rectangle(2, 3, 1), kOptions);
  EXPECT_LT(e.accuracy_m.max, 1e-6);
  for (const MeshScore& s : e.scores) EXPECT_EQ(s.f_score, 1);
}

TEST(MeshError, ParallelPlanesThreeCentimetresApart) {
  const MeshErrors e = measureMesh(rectangle(2, 3, 1.03f), rectangle(2, 3, 1), kOptions);
  EXPECT_NEAR(e.accuracy_m.rmse, 0.03, 1e-6);
  EXPECT_NEAR(e.accuracy_m.max, 0.03, 1e-6) << "distances are exact, not those to the nearest sample";
  EXPECT_NEAR(e.truth_to_reconstruction_m.rmse, 0.03, 1e-6);
  ASSERT_EQ(e.scores.size(), 2u);
  EXPECT_EQ(e.scores[0].threshold_m, 0.05);
  EXPECT_EQ(e.scores[0].f_score, 1);
  MeshErrorOptions strict = kOptions;
  strict.thresholds_m = {0.02};
  EXPECT_EQ(measureMesh(rectangle(2, 3, 1.03f), rectangle(2, 3, 1), strict).scores[0].f_score, 0);
}

TEST(MeshError, HalfThePlaneIsHalfComplete) {
  const MeshErrors e = measureMesh(rectangle(5, 3, 0), rectangle(10, 3, 0), kOptions);
  // Truth within 5 cm beyond the edge counts: 5.05 m and 5.15 m of 10 m.
  EXPECT_NEAR(e.scores[0].completeness, 0.505, kShareTolerance);
  EXPECT_NEAR(e.scores[1].completeness, 0.515, kShareTolerance);
  EXPECT_EQ(e.scores[0].precision, 1);
  EXPECT_NEAR(e.scores[0].f_score, 2 * 0.505 / 1.505, kShareTolerance);
  EXPECT_LT(e.accuracy_m.max, 1e-6);
}

TEST(MeshError, SurfaceThatIsNotThereLowersPrecision) {
  TriangleMesh reconstruction = rectangle(2, 3, 0);
  const TriangleMesh ghost = rectangle(2, 3, 1);  // a second plane, 1 m off
  reconstruction.vertices.insert(reconstruction.vertices.end(), ghost.vertices.begin(), ghost.vertices.end());
  reconstruction.triangles.insert(reconstruction.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
  const MeshErrors e = measureMesh(reconstruction, rectangle(2, 3, 0), kOptions);
  EXPECT_EQ(e.scores[0].completeness, 1);
  EXPECT_NEAR(e.scores[0].precision, 0.5, kShareTolerance);
  EXPECT_NEAR(e.accuracy_m.rmse, std::sqrt(0.5), kShareTolerance);
  EXPECT_LT(e.inlier_accuracy_m.max, 1e-6) << "the ghost is no inlier";
}

TEST(MeshError, TransformLeadsIntoTheTruthsFrame) {
  const Pose truth_from_reconstruction = somewhere();
  TriangleMesh reconstruction = rectangle(2, 3, 0.04f);
  for (Eigen::Vector3f& v : reconstruction.vertices)
    v = (truth_from_reconstruction.inverse() * v.cast<double>()).cast<float>();
  MeshErrorOptions options = kOptions;
  options.truth_from_reconstruction = truth_from_reconstruction;
  const MeshErrors e = measureMesh(reconstruction, rectangle(2, 3, 0), options);
  EXPECT_NEAR(e.accuracy_m.rmse, 0.04, 1e-5);
  EXPECT_NEAR(e.truth_to_reconstruction_m.rmse, 0.04, 1e-5);
}

TEST(MeshError, NothingNearby) {
  const MeshErrors e = measureMesh(rectangle(2, 3, 50), rectangle(2, 3, 0), kOptions);
  EXPECT_NEAR(e.accuracy_m.rmse, 50, 1e-3);
  EXPECT_EQ(e.inlier_accuracy_m.count, 0u);
  EXPECT_EQ(e.scores[1].f_score, 0);
  EXPECT_THAT(toJson(e).dump(), HasSubstr("\"inlier_accuracy_rms_m\":null"));
}

TEST(MeshError, PointCloudsAreMeasuredByTheirPoints) {
  TriangleMesh scan;  // a centimetre grid on the plane z = 0
  for (int x = 0; x <= 200; ++x)
    for (int y = 0; y <= 100; ++y)
      scan.vertices.emplace_back(0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 0.0f);
  const MeshErrors e = measureMesh(rectangle(2, 1, 0.03f), scan, {.samples = 30000});
  EXPECT_EQ(e.truth_samples, scan.vertices.size());
  EXPECT_NEAR(e.truth_to_reconstruction_m.rmse, 0.03, 1e-6);
  // To the grid's points a little more: mean square offset in a 1 cm cell is 1/6 cm^2.
  EXPECT_NEAR(e.accuracy_m.rmse, std::sqrt(0.0009 + 1e-4 / 6), 1e-5);
  EXPECT_EQ(e.scores[0].f_score, 1);
}

TEST(MeshError, SameSeedSameFigures) {
  const TriangleMesh a = rectangle(2, 3, 0), b = rectangle(3, 2, 0.02f);
  EXPECT_EQ(toJson(measureMesh(a, b, kOptions)).dump(), toJson(measureMesh(a, b, kOptions)).dump());
}

TEST(MeshReport, HasTheNamesOfTheThresholds) {
  const auto json = toJson(measureMesh(rectangle(2, 3, 1), rectangle(2, 3, 1), kOptions));
  for (const char* name : {"accuracy_rms_m", "inlier_accuracy_rms_m", "completeness_5cm", "precision_5cm",
                           "f_score_5cm", "completeness_15cm", "f_score_15cm"})
    EXPECT_TRUE(json.contains(name) && json[name].is_number()) << name;
}

TEST(MeshError, BadMeshesAreNamed) {
  const TriangleMesh good = rectangle(1, 1, 0);
  TriangleMesh not_finite = good, dangling = good, flat = good;
  not_finite.vertices[2].y() = std::numeric_limits<float>::quiet_NaN();
  dangling.triangles[1][2] = 4;
  for (Eigen::Vector3f& v : flat.vertices) v.y() = v.z() = 0;
  MeshErrorOptions options = kOptions;
  options.reconstruction_name = "mesh.ply";
  EXPECT_THAT(inputErrorOf([&] { measureMesh({}, good, options); }),
              AllOf(StartsWith("mesh.ply: "), HasSubstr("no vertices")));
  EXPECT_THAT(inputErrorOf([&] { measureMesh(good, {}, options); }), StartsWith("the truth: "));
  EXPECT_THAT(inputErrorOf([&] { measureMesh(not_finite, good, options); }), HasSubstr("not finite"));
  EXPECT_THAT(inputErrorOf([&] { measureMesh(dangling, good, options); }), HasSubstr("names vertex 4 of 4"));
  EXPECT_THAT(inputErrorOf([&] { measureMesh(flat, good, options); }), HasSubstr("no area"));
}

TEST(MeshError, OwnOriginsCancelBeforeFloatsSeeThem) {
  const TriangleMesh near_truth = rectangle(2, 3, 0), near_mesh = rectangle(2, 3, 0.1f);
  TriangleMesh truth = near_truth, mesh = near_mesh;
  truth.origin = {500000, 5400000, 300};
  mesh.origin = {500001, 5400002, 300};  // the same place, told from another origin
  for (Eigen::Vector3f& v : mesh.vertices) v -= Eigen::Vector3f(1, 2, 0);
  const double wanted = measureMesh(near_mesh, near_truth).accuracy_m.rmse;
  EXPECT_NEAR(measureMesh(mesh, truth).accuracy_m.rmse, wanted, 1e-5);
  EXPECT_NEAR(wanted, 0.1, 1e-5);
  MeshErrorOptions options;  // a pose between the two large frames
  options.truth_from_reconstruction.translation() = Eigen::Vector3d(0, 0, -0.1);
  EXPECT_NEAR(measureMesh(mesh, truth, options).accuracy_m.rmse, 0, 1e-5);
}

}  // namespace test_mesh_error
}  // namespace rosefusion::testing
