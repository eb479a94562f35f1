#include "host/slam/loop_closure/pose_graph.h"

#include <ceres/ceres.h>

namespace rosefusion {
namespace {

struct Node {
  Eigen::Vector3d position;
  Eigen::Quaterniond turn;
};

struct EdgeError {
  Eigen::Vector3d shift;
  Eigen::Quaterniond turn;
  double shift_weight, turn_weight;

  explicit EdgeError(const PoseEdge& edge)
      : shift(edge.first_from_second.translation()),
        turn(edge.first_from_second.linear()),
        shift_weight(1 / edge.shift_deviation),
        turn_weight(1 / edge.turn_deviation) {}

  template <typename T>
  bool operator()(const T* p1, const T* q1, const T* p2, const T* q2, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    using Quaternion = Eigen::Quaternion<T>;
    const Eigen::Map<const Vector> position1(p1), position2(p2);
    const Eigen::Map<const Quaternion> turn1(q1), turn2(q2);
    const Quaternion back = turn1.conjugate();
    const Quaternion off = turn.cast<T>().conjugate() * (back * turn2);
    Eigen::Map<Vector> shifts(residual), turns(residual + 3);
    shifts = T(shift_weight) * (back * (position2 - position1) - shift.cast<T>());
    turns = T(2 * turn_weight) * off.vec() * (off.w() < T(0) ? T(-1) : T(1));
    return true;
  }
};

}  // namespace

std::vector<Pose> optimisePoses(std::vector<Pose> poses, std::span<const PoseEdge> edges) {
  if (poses.empty() || edges.empty()) return poses;
  std::vector<Node> nodes;
  for (const Pose& pose : poses) nodes.push_back({pose.translation(), Eigen::Quaterniond(pose.linear())});
  ceres::EigenQuaternionManifold quaternions;
  ceres::Problem::Options shared;
  shared.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(shared);
  for (Node& node : nodes) {
    problem.AddParameterBlock(node.position.data(), 3);
    problem.AddParameterBlock(node.turn.coeffs().data(), 4, &quaternions);
  }
  problem.SetParameterBlockConstant(nodes[0].position.data());
  problem.SetParameterBlockConstant(nodes[0].turn.coeffs().data());
  for (const PoseEdge& edge : edges) {
    Node &first = nodes[edge.first], &second = nodes[edge.second];
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeError, 6, 3, 4, 3, 4>(new EdgeError(edge)),
                             nullptr, first.position.data(), first.turn.coeffs().data(),
                             second.position.data(), second.turn.coeffs().data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 50;
  options.num_threads = 1;  // sums in one order
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    poses[i].translation() = nodes[i].position;
    poses[i].linear() = nodes[i].turn.normalized().toRotationMatrix();
  }
  return poses;
}

double residualOf(const PoseEdge& edge, std::span<const Pose> poses) {
  const Pose motion = poses[edge.first].inverse() * poses[edge.second];
  return (motion.translation() - edge.first_from_second.translation()).norm();
}

}  // namespace rosefusion
