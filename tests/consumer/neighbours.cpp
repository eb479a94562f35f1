// An application that uses Vulkan-Hpp, Eigen and glm itself, each set up in a way that changes what their
// templates and inline functions are: its copies and rosefusion's must not meet in the linker. Compiled
// without optimisation, so that there are copies at all, and with the address sanitizer.
#define VK_ENABLE_BETA_EXTENSIONS  // more members in the dispatchers
#define VULKAN_HPP_DISPATCH_LOADER_DYNAMIC 1
#define GLM_FORCE_DEFAULT_ALIGNED_GENTYPES
#define GLM_FORCE_DEPTH_ZERO_TO_ONE
#include <rosefusion/reconstructor.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <glm/glm.hpp>
#include <vulkan/vulkan_raii.hpp>

bool readCamera(std::vector<std::uint16_t>& depth, double& seconds);

namespace {

// Of the sizes that a camera's pose has, as rosefusion's are; with EIGEN_MAX_ALIGN_BYTES=64 and the vectors
// of a newer processor (CMakeLists.txt) they lie otherwise in memory, and dynamic ones are allocated by
// another function.
double solved() {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const Matrix6 a = Matrix6::Identity() * 2 + Matrix6::Constant(1);
  const Vector6 b = a.ldlt().solve(Vector6::Constant(8));  // ones
  const Eigen::SelfAdjointEigenSolver<Matrix6> values(a);  // the largest is 8
  const Eigen::MatrixXd dynamic = Eigen::MatrixXd::Constant(6, 6, 1) * b;
  const glm::mat4 product = glm::inverse(glm::mat4(2)) * glm::mat4(3);
  return values.eigenvalues()[5] + dynamic(5, 0) + product[3][3];  // 8 + 6 + 3 / 2
}

std::size_t deviceOfItsOwn() {
  const vk::raii::Context context;
  const vk::ApplicationInfo application("neighbours", 1, "neighbours", 1, VK_API_VERSION_1_1);
  const vk::raii::Instance instance(context, vk::InstanceCreateInfo({}, &application));
  const vk::raii::PhysicalDevices physicals(instance);
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue({}, 0, 1, &priority);
  const vk::raii::Device device(physicals.front(), vk::DeviceCreateInfo({}, queue));
  return device.getQueue(0, 0).getDispatcher() ? physicals.size() : 0;
}

}  // namespace

int main() {
  const double before = solved();
  const std::size_t devices = deviceOfItsOwn();
  rosefusion::Reconstructor reconstructor({320, 240, 160, 160, 159.5, 119.5, 1000});
  std::vector<std::uint16_t> depth;
  rosefusion::Result last;
  for (double seconds = 0; readCamera(depth, seconds);) last = reconstructor.process({depth, seconds});
  const double x = last.world_from_camera[12];
  std::printf("%zu devices, %.3f and %.3f, camera at %.3f m\n", devices, before, solved(), x);
  return devices > 0 && std::abs(before - 15.5) < 1e-9 && solved() == before && x > 0.20 && x < 0.22 ? 0 : 1;
}
