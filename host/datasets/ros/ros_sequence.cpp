// Depth images among the messages of a ROS recording, with the camera that belongs to them.
#include <algorithm>
#include <cctype>
#include <map>

#include "host/core/error.h"
#include "host/datasets/camera_source.h"
#include "host/datasets/listing.h"
#include "host/datasets/ros/message_file.h"
#include "host/datasets/ros/ros_messages.h"

namespace rosefusion::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kAttempts = 10;  // messages looked at to see what a topic holds
constexpr double kTogether = 0.05;     // seconds between a depth image and its colour image

bool saysDepth(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.find("depth") != std::string::npos;
}

std::size_t sharedBeginning(const std::string& a, const std::string& b) {
  const auto differ = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  return static_cast<std::size_t>(differ.first - a.begin());
}

class RosSequence : public Sequence {
 public:
  RosSequence(std::unique_ptr<MessageFile> messages, const fs::path& file, const std::string& format,
              const SequenceOptions& options)
      : messages_(std::move(messages)), load_colour_(options.colour) {
    info_.format = format;
    info_.path = file;
    info_.warnings = messages_->warnings();
    for (const MessageRef& m : messages_->messages()) of_topic_[m.topic].push_back(&m);
    const std::size_t depth_topic = chooseDepth(options.topic);
    frames_ = of_topic_[depth_topic];
    info_.frames = frames_.size();
    const DepthMessage first = firstDepth(depth_topic);
    const auto camera = cameraOf(depth_topic, &info_.warnings);
    chooseColour(first.depth.size(), camera);
    if (!camera && !options.intrinsics)
      throw InputError(file.string() + ": no camera_info belongs to " + nameOf(depth_topic) +
                       "; give --intrinsics FX,FY,CX,CY.");
    chooseCamera(camera.value_or(CameraSource{}), unitsOf(first), false, options, first.depth.cols,
                 first.depth.rows, info_);
    if (!options.intrinsics && camera->distortion)
      undistortion_.emplace(*camera->distortion, info_.intrinsics);
  }

  double timestamp(std::size_t index) const override { return frames_.at(index)->timestamp; }

  bool read(std::size_t index, Frame& frame, std::string& problem) override {
    problem.clear();
    frame = {};
    frame.timestamp = timestamp(index);
    try {
      const MessageRef& message = *frames_.at(index);
      const auto depth = depthOf(messages_->read(message), messages_->isCdr(), typeOf(message.topic));
      const cv::Size size(info_.intrinsics.width, info_.intrinsics.height);
      if (!depth || depth->depth.size() != size) throw EndOfBytes();
      frame.depth = depth->depth;
    } catch (const std::exception&) {
      frame.depth.release();
      problem = info_.path.string() + ": depth image " + std::to_string(index) +
                " is damaged or of another kind than the first; it is left out.";
      return false;
    }
    if (load_colour_) readColour(frame, problem);
    if (undistortion_) {
      undistortion_->undistortDepth(frame.depth);
      if (!frame.colour.empty()) undistortion_->undistortColour(frame.colour);
    }
    return true;
  }

 private:
  const std::string& nameOf(std::size_t topic) const { return messages_->topics()[topic].name; }
  const std::string& typeOf(std::size_t topic) const { return messages_->topics()[topic].type; }

  std::optional<DepthMessage> tryDepth(const MessageRef& message) {
    try {
      return depthOf(messages_->read(message), messages_->isCdr(), typeOf(message.topic));
    } catch (const EndOfBytes&) {
      return {};
    }
  }
  /// One damaged message does not hide a topic.
  bool showsDepth(const std::vector<const MessageRef*>& messages) {
    const auto some = messages.begin() + static_cast<std::ptrdiff_t>(std::min(messages.size(), kAttempts));
    return std::any_of(messages.begin(), some, [&](const MessageRef* m) { return tryDepth(*m).has_value(); });
  }
  DepthMessage firstDepth(std::size_t topic) {
    for (const MessageRef* m : of_topic_[topic])
      if (const auto depth = tryDepth(*m)) return *depth;
    throw InputError(info_.path.string() + ": no image of " + nameOf(topic) + " can be read; copy it again.");
  }

  std::size_t chooseDepth(const std::string& wanted) {
    std::vector<std::size_t> found;
    std::string images;
    for (const auto& [topic, messages] : of_topic_) {
      if (typeOf(topic) != "sensor_msgs/Image" && typeOf(topic) != "sensor_msgs/CompressedImage") continue;
      images += (images.empty() ? "" : ", ") + nameOf(topic);
      if (!wanted.empty() && nameOf(topic) == wanted) return topic;
      if (wanted.empty() && showsDepth(messages)) found.push_back(topic);
    }
    if (!wanted.empty())
      throw InputError(info_.path.string() + ": has no images on topic " + wanted + "; there are " +
                       (images.empty() ? "none at all" : images) + ".");
    if (found.empty())
      throw InputError(info_.path.string() + ": holds no depth images (16UC1, 32FC1 or compressedDepth); " +
                       "there are " + (images.empty() ? "no images at all" : "images on " + images) + ".");
    const auto best = std::max_element(found.begin(), found.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(saysDepth(nameOf(a)), of_topic_[a].size()) <
             std::pair(saysDepth(nameOf(b)), of_topic_[b].size());
    });
    info_.notes.push_back("depth images of " + nameOf(*best) +
                          (found.size() > 1 ? ", of several topics; --topic chooses" : ""));
    return *best;
  }

  /// `warnings`: of a lens that is not known.
  std::optional<CameraSource> cameraOf(std::size_t depth_topic,
                                       std::vector<std::string>* warnings = nullptr) {
    std::optional<std::size_t> best;
    for (const auto& [topic, messages] : of_topic_)
      if ((typeOf(topic) == "sensor_msgs/CameraInfo" ||
           (typeOf(topic) == "std_msgs/String" && nameOf(topic).ends_with("camera_info"))) &&
          (!best || sharedBeginning(nameOf(topic), nameOf(depth_topic)) >
                        sharedBeginning(nameOf(*best), nameOf(depth_topic))))
        best = topic;
    if (!best) return {};
    try {
      const auto message = messages_->read(*of_topic_[*best].front());
      const CameraInfoMessage camera = typeOf(*best) == "std_msgs/String"
                                           ? cameraInfoOfText(textOf(message, messages_->isCdr()))
                                           : cameraInfoOf(message, messages_->isCdr());
      CameraSource out{{static_cast<int>(camera.width), static_cast<int>(camera.height), camera.k[0],
                        camera.k[4], camera.k[2], camera.k[5]},
                       info_.path.string() + ", topic " + nameOf(*best),
                       false,
                       {}};
      const auto lens = camera.lens();
      // 'rect' in the topic's name: the images were undistorted before they were recorded.
      const bool straight = lens == Distortion{} || nameOf(depth_topic).find("rect") != std::string::npos;
      if (!straight && lens) out.distortion = lens;
      if (!straight && !lens && warnings)
        warnings->push_back(info_.path.string() + ": the lens of " + nameOf(*best) + " is of the model '" +
                            camera.distortion_model + "', which is not known: images are used as they " +
                            "are; record undistorted ones (image_proc's image_rect).");
      return out;
    } catch (const EndOfBytes&) {
      throw InputError(info_.path.string() + ": " + nameOf(*best) +
                       " is damaged; give --intrinsics FX,FY,CX,CY.");
    }
  }

  /// Of 16 bits: millimetres, or what a RealSense camera says its unit is.
  double unitsOf(const DepthMessage& first) {
    if (first.metres) return kUnitsOfMetres;
    for (const auto& [topic, messages] : of_topic_) {
      const std::string& name = nameOf(topic);
      if (typeOf(topic) != "std_msgs/Float32" || (name.find("Depth Units/value") == std::string::npos &&
                                                  name.find("Depth_Units/value") == std::string::npos))
        continue;
      try {
        const double metres = floatOf(messages_->read(*messages.front()), messages_->isCdr());
        if (metres > 0 && metres < 1) return 1 / metres;
      } catch (const EndOfBytes&) {
      }
    }
    return 1000;
  }

  /// Depth that was registered to a colour image has that image's camera, to the last digit.
  bool isRegistered(std::size_t colour_topic, const std::optional<CameraSource>& depth_camera) {
    const auto camera = cameraOf(colour_topic);
    return !camera || !depth_camera || camera->values == depth_camera->values;
  }

  void chooseColour(const cv::Size& size, const std::optional<CameraSource>& depth_camera) {
    std::string others;
    for (const auto& [topic, messages] : of_topic_) {
      cv::Mat colour;
      try {
        colour = colourOf(messages_->read(*messages.front()), messages_->isCdr(), typeOf(topic));
      } catch (const EndOfBytes&) {
      }
      if (colour.empty()) continue;
      const bool registered = colour.size() == size && isRegistered(topic, depth_camera);
      if (registered && !info_.has_colour) {
        colour_ = messages;
        info_.has_colour = true;
      } else if (!registered) {
        others += (others.empty() ? "" : ", ") + nameOf(topic);
      }
    }
    if (!info_.has_colour && !others.empty())
      info_.notes.push_back("colour (" + others + ") is not registered to the depth images and left out");
  }

  void readColour(Frame& frame, std::string& problem) {
    const auto later = std::lower_bound(colour_.begin(), colour_.end(), frame.timestamp,
                                        [](const MessageRef* m, double time) { return m->timestamp < time; });
    const MessageRef* nearest = nullptr;
    for (const auto candidate : {later, later == colour_.begin() ? later : later - 1})
      if (candidate != colour_.end() && (!nearest || std::abs((*candidate)->timestamp - frame.timestamp) <
                                                         std::abs(nearest->timestamp - frame.timestamp)))
        nearest = *candidate;
    if (!nearest || std::abs(nearest->timestamp - frame.timestamp) > kTogether) return;
    try {
      frame.colour = colourOf(messages_->read(*nearest), messages_->isCdr(), typeOf(nearest->topic));
    } catch (const std::exception&) {
      frame.colour.release();
    }
    if (frame.colour.size() == frame.depth.size()) return;
    frame.colour.release();
    problem =
        info_.path.string() + ": a colour image is damaged or of another size; the frame has depth only.";
  }

  std::unique_ptr<MessageFile> messages_;
  bool load_colour_;
  std::map<std::size_t, std::vector<const MessageRef*>> of_topic_;
  std::vector<const MessageRef*> frames_, colour_;
  std::optional<Undistortion> undistortion_;
};

}  // namespace

std::unique_ptr<Sequence> openRosRecording(const fs::path& file, const SequenceOptions& options) {
  const std::string ending = file.extension().string();
  if (ending == ".bag") return std::make_unique<RosSequence>(openRosBag(file), file, "ROS bag", options);
  if (ending == ".mcap") return std::make_unique<RosSequence>(openMcap(file), file, "MCAP", options);
  return std::make_unique<RosSequence>(openRos2Database(file), file, "ROS 2 database", options);
}

}  // namespace rosefusion::datasets
