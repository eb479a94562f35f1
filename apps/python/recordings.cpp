#include "apps/python/recordings.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <opencv2/core.hpp>

#include "apps/python/others_may_run.h"
#include "host/core/error.h"
#include "host/datasets/sequence.h"
#include "rosefusion/types.h"

namespace py = pybind11;
using namespace py::literals;

namespace {

using rosefusion::Sequence;

struct LoadedFrame {
  double timestamp = 0;
  py::array_t<std::uint16_t> depth;
  py::object rgb = py::none();
};

py::array_t<double> toArray(const rosefusion::Pose& pose) {
  py::array_t<double> out({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out.mutable_at(row, column) = pose.matrix()(row, column);
  return out;
}

class Recording {
 public:
  explicit Recording(std::unique_ptr<Sequence> sequence) : sequence_(std::move(sequence)) {}

  const rosefusion::SequenceInfo& info() const { return sequence_->info(); }
  std::size_t size() const { return sequence_->size(); }
  rosefusion::Camera camera() const {
    const rosefusion::Intrinsics& k = info().intrinsics;
    return {k.width, k.height, k.fx, k.fy, k.cx, k.cy, info().depth_units_per_metre};
  }
  py::list truth() const {
    py::list out;
    for (const rosefusion::StampedPose& pose : info().truth)
      out.append(py::make_tuple(seconds(pose.timestamp), toArray(pose.world_from_camera)));
    return out;
  }

  /// None where the frame's depth cannot be used, which the log tells, as it tells of colour alone.
  py::object read(std::size_t index) {
    rosefusion::Frame frame;
    std::string problem;
    bool usable = false;
    {
      const OthersMayRun others_may_run;
      usable = sequence_->read(index, frame, problem);
    }
    if (!problem.empty())
      py::module_::import("logging").attr("getLogger")("rosefusion").attr("warning")(problem);
    if (!usable) return py::none();
    LoadedFrame out{seconds(frame.timestamp),
                    py::array_t<std::uint16_t>({frame.depth.rows, frame.depth.cols}), py::none()};
    for (int v = 0; v < frame.depth.rows; ++v)
      std::copy_n(frame.depth.ptr<std::uint16_t>(v), frame.depth.cols, out.depth.mutable_data(v, 0));
    if (!frame.colour.empty()) {
      py::array_t<std::uint8_t> rgb({frame.colour.rows, frame.colour.cols, 3});
      for (int v = 0; v < frame.colour.rows; ++v)
        for (int u = 0; u < frame.colour.cols; ++u)
          for (int k = 0; k < 3; ++k) rgb.mutable_at(v, u, k) = frame.colour.at<cv::Vec3b>(v, u)[2 - k];
      out.rgb = rgb;
    }
    return py::cast(out);
  }

 private:
  double seconds(double stamp) const { return info().seconds_per_stamp * stamp; }

  std::unique_ptr<Sequence> sequence_;
};

/// Goes on over frames that cannot be used.
struct Frames {
  py::object owner;
  Recording* recording;
  std::size_t next = 0;
};

std::unique_ptr<Recording> load(const std::string& path, bool colour,
                                const std::optional<std::array<double, 4>>& intrinsics,
                                const std::optional<double>& units, const std::string& topic) {
  rosefusion::SequenceOptions options;
  options.colour = colour;
  if (intrinsics) {
    const auto& k = *intrinsics;
    options.intrinsics = rosefusion::Intrinsics{0, 0, k[0], k[1], k[2], k[3]};
  }
  options.depth_units_per_metre = units;
  options.topic = topic;
  try {
    return std::make_unique<Recording>(rosefusion::openSequence(path, options));
  } catch (const rosefusion::InputError& error) {
    throw rosefusion::Error(rosefusion::Error::Kind::BadInput, error.what());
  }
}

}  // namespace

void addRecordings(py::module_& m) {
  py::class_<LoadedFrame>(m, "LoadedFrame", "One frame of a recording.")
      .def_readonly("timestamp", &LoadedFrame::timestamp, "Seconds.")
      .def_readonly("depth", &LoadedFrame::depth, "uint16, height x width; 0 and 65535 are invalid.")
      .def_readonly("rgb", &LoadedFrame::rgb, "uint8, height x width x 3; None where there is none.");
  py::class_<Frames>(m, "_Frames")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](Frames& frames) {
        while (frames.next < frames.recording->size())
          if (py::object frame = frames.recording->read(frames.next++); !frame.is_none()) return frame;
        throw py::stop_iteration();
      });
  py::class_<Recording>(m, "Recording",
                        "Frames in the order of their time; iterate, or take one by its index.")
      .def("__len__", &Recording::size)
      .def(
          "__getitem__",
          [](Recording& recording, std::ptrdiff_t index) {
            const auto size = static_cast<std::ptrdiff_t>(recording.size());
            if (index < 0) index += size;
            if (index < 0 || index >= size) throw py::index_error("the recording has no such frame");
            return recording.read(static_cast<std::size_t>(index));
          },
          "The frame, or None where its depth cannot be used.")
      .def("__iter__",
           [](py::object self) {
             return Frames{self, self.cast<Recording*>(), 0};
           })
      .def_property_readonly("camera", &Recording::camera, "Of the depth images, for Reconstructor().")
      .def_property_readonly("format", [](const Recording& r) { return r.info().format; })
      .def_property_readonly("has_colour", [](const Recording& r) { return r.info().has_colour; })
      .def_property_readonly("truth", &Recording::truth,
                             "(timestamp, world_from_camera) where the recording comes with it.")
      .def_property_readonly("notes", [](const Recording& r) { return r.info().notes; })
      .def_property_readonly("warnings", [](const Recording& r) { return r.info().warnings; });
  m.def("load", &load, "path"_a, "colour"_a = true, "intrinsics"_a = py::none(),
        "depth_units_per_metre"_a = py::none(), "topic"_a = "",
        "Opens a recording of any kind that 'rosefusion run' reads. intrinsics: (fx, fy, cx, cy), instead of "
        "the "
        "recording's own. Raises Error, whose sentence says what is wrong and what to do.");
}
