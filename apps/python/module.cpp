// The Python module: the public headers, with NumPy arrays for images, poses and meshes.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "apps/python/others_may_run.h"
#include "rosefusion/reconstructor.h"
#ifdef ROSEFUSION_RECORDINGS
#include "apps/python/recordings.h"
#endif

namespace py = pybind11;
using namespace py::literals;
using namespace rosefusion;

namespace {

// noconvert() below: an array of another type is refused, not rounded.
using DepthArray = py::array_t<std::uint16_t, py::array::c_style>;
using ColourArray = py::array_t<std::uint8_t, py::array::c_style>;
using PoseArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// NumPy's rows are Matrix's columns.
py::array_t<double> toArray(const Matrix& matrix) {
  py::array_t<double> out({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out.mutable_at(row, column) = matrix[4 * column + row];
  return out;
}

Matrix toMatrix(const PoseArray& array) {
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    throw py::value_error("a pose must be an array of 4 x 4");
  Matrix out;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out[4 * column + row] = array.at(row, column);
  return out;
}

template <typename T>
py::array_t<T> toArray(const std::vector<std::array<T, 3>>& rows) {
  py::array_t<T> out({rows.size(), std::size_t(3)});
  std::copy_n(reinterpret_cast<const T*>(rows.data()), 3 * rows.size(), out.mutable_data());
  return out;
}

/// A motion of 4 x 4, or its rotation alone.
MotionPrior toMotion(const PoseArray& array) {
  if (array.ndim() != 2 || array.shape(0) != 3 || array.shape(1) != 3) return {toMatrix(array), true};
  MotionPrior motion;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      motion.last_camera_from_camera[4 * column + row] = array.at(row, column);
  return motion;
}

/// The arrays must outlive it.
DepthFrame toFrame(const Camera& camera, const DepthArray& depth, double timestamp,
                   const std::optional<ColourArray>& rgb) {
  const bool fits = depth.ndim() == 2 && depth.shape(0) == camera.height && depth.shape(1) == camera.width &&
                    (!rgb || (rgb->ndim() == 3 && rgb->shape(0) == camera.height &&
                              rgb->shape(1) == camera.width && rgb->shape(2) == 3));
  if (!fits)
    throw py::value_error("depth must be an array of " + std::to_string(camera.height) + " x " +
                          std::to_string(camera.width) + " (rows x columns), rgb of 3 values for each");
  DepthFrame frame{{depth.data(), static_cast<std::size_t>(depth.size())}, timestamp, {}};
  if (rgb) frame.rgb = {rgb->data(), static_cast<std::size_t>(rgb->size())};
  return frame;
}

struct PyReconstructor {
  Camera camera;
  Reconstructor reconstructor;

  PyReconstructor(const Camera& its_camera, const std::string& preset, const py::dict& settings,
                  const std::string& device)
      : camera(its_camera), reconstructor([&] {
          Options options{.preset = preset, .settings = {}, .device = device};
          for (const auto& [key, value] : settings)
            options.settings.push_back({py::str(key), py::isinstance<py::bool_>(value)
                                                          ? (value.cast<bool>() ? "true" : "false")
                                                          : std::string(py::str(value))});
          options.log = [](LogLevel level, const std::string& sentence) {
            unlessPythonEnded([&] {
              const py::gil_scoped_acquire python;
              py::module_::import("logging")
                  .attr("getLogger")("rosefusion")
                  .attr(level == LogLevel::Warning ? "warning" : "info")(sentence);
            });
          };
          const OthersMayRun others_may_run;
          return Reconstructor(its_camera, options);
        }()) {}

  Result process(const DepthArray& depth, double timestamp, const std::optional<ColourArray>& rgb,
                 const std::optional<PoseArray>& motion) {
    DepthFrame frame = toFrame(camera, depth, timestamp, rgb);
    if (motion) frame.motion = toMotion(*motion);
    const OthersMayRun others_may_run;
    return reconstructor.process(frame);
  }
  void integrate(const DepthArray& depth, const PoseArray& pose, double timestamp,
                 const std::optional<ColourArray>& rgb) {
    const DepthFrame frame = toFrame(camera, depth, timestamp, rgb);
    const Matrix matrix = toMatrix(pose);
    const OthersMayRun others_may_run;
    reconstructor.integrate(frame, matrix);
  }
  Mesh mesh() {
    const OthersMayRun others_may_run;
    return reconstructor.mesh();
  }
  py::list trajectory() const {
    py::list out;
    for (const TimedPose& pose : reconstructor.trajectory())
      out.append(py::make_tuple(pose.timestamp, toArray(pose.world_from_camera)));
    return out;
  }
};

}  // namespace

PYBIND11_MODULE(rosefusion, m) {
  m.doc() = "Online dense reconstruction from a fast-moving depth camera.";
  m.attr("__version__") = ROSEFUSION_VERSION;
  py::register_exception<Error>(m, "Error", PyExc_RuntimeError);

  py::enum_<Status>(m, "Status")
      .value("TRACKED", Status::Tracked)
      .value("UNCERTAIN", Status::Uncertain)
      .value("RELOCALISED", Status::Relocalised)
      .value("LOST", Status::Lost);
  py::class_<Camera>(m, "Camera", "A pinhole camera, in pixels; pixel centres have integer coordinates.")
      .def(py::init<int, int, double, double, double, double, double>(), "width"_a, "height"_a, "fx"_a,
           "fy"_a, "cx"_a, "cy"_a, "depth_units_per_metre"_a = 1000)
      .def_readonly("width", &Camera::width)
      .def_readonly("height", &Camera::height)
      .def_readonly("fx", &Camera::fx)
      .def_readonly("fy", &Camera::fy)
      .def_readonly("cx", &Camera::cx)
      .def_readonly("cy", &Camera::cy)
      .def_readonly("depth_units_per_metre", &Camera::depth_units_per_metre);
  py::class_<Result>(m, "Result", "What became of one frame. Poses: 4 x 4, metres, camera to world.")
      .def_readonly("timestamp", &Result::timestamp)
      .def_readonly("status", &Result::status)
      .def_readonly("reason", &Result::reason)
      .def_readonly("residual", &Result::residual)
      .def_readonly("overlap", &Result::overlap)
      .def_readonly("milliseconds", &Result::milliseconds)
      .def_readonly("began_anew", &Result::began_anew)
      .def_property_readonly("covariance",
                             [](const Result& r) {
                               return py::array_t<double>({6, 6}, r.covariance.data());
                             })
      .def_property_readonly("world_from_camera",
                             [](const Result& r) { return toArray(r.world_from_camera); });
  py::class_<Mesh>(m, "Mesh", "World frame, metres; arrays of three columns.")
      .def_property_readonly("vertices", [](const Mesh& mesh) { return toArray(mesh.vertices); })
      .def_property_readonly("normals", [](const Mesh& mesh) { return toArray(mesh.normals); })
      .def_property_readonly("colours", [](const Mesh& mesh) { return toArray(mesh.colours); })
      .def_property_readonly("triangles", [](const Mesh& mesh) { return toArray(mesh.triangles); });
  const auto init = py::init<const Camera&, const std::string&, const py::dict&, const std::string&>();
  py::class_<PyReconstructor>(m, "Reconstructor",
                              "Follows one camera and builds one model, on a Vulkan device of its own.")
      .def(init, "camera"_a, "preset"_a = "default", "settings"_a = py::dict(), "device"_a = "")
      .def(init, "intrinsics"_a, "preset"_a = "default", "settings"_a = py::dict(), "device"_a = "")
      .def(
          "process", &PyReconstructor::process, "depth"_a.noconvert(), "timestamp"_a, "rgb"_a = py::none(),
          "motion"_a = py::none(),
          "Tracks and fuses one frame: depth as uint16, height x width; timestamp in seconds; motion: what "
          "another sensor says, the camera's pose in the frame of the camera before (4 x 4), or its rotation "
          "(3 x 3).")
      .def("integrate", &PyReconstructor::integrate, "depth"_a.noconvert(), "world_from_camera"_a,
           "timestamp"_a, "rgb"_a = py::none(),
           "Fuses one frame at a known pose; tracking goes on from there.")
      .def("mesh", &PyReconstructor::mesh, "The model's surface now.")
      .def("trajectory", &PyReconstructor::trajectory,
           "(timestamp, world_from_camera) of all frames not lost.");
#ifdef ROSEFUSION_RECORDINGS
  addRecordings(m);
#endif
  // As they were called at first.
  m.attr("Intrinsics") = m.attr("Camera");
  m.attr("Pipeline") = m.attr("Reconstructor");
}
