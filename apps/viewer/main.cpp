// rosefusion-viewer: watch a room appear.
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "apps/chosen_settings.h"
#include "apps/cli/exit_code.h"
#include "apps/guarded_main.h"
#include "apps/viewer/imgui_versions.h"
#include "apps/viewer/panels.h"
#include "apps/viewer/scene.h"
#include "apps/viewer/window.h"
#include "host/core/error.h"

namespace rosefusion::viewer {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string source, config = "default", sensor, device, screenshot, out = "out/viewer";
  std::vector<std::string> assignments;
  std::vector<double> intrinsics;
  StreamOptions stream;
  int width = 1280, height = 800;
  std::size_t after_frames = 0;
  bool headless = false, realtime = false, play = false, validation = false;
};

/// ImGui's context; its backends come and go within.
struct Gui {
  Gui() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    setUpStyle();
  }
  ~Gui() { ImGui::DestroyContext(); }
};

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Everything but the window.
class Viewer {
 public:
  Viewer(const Options& options, Gpu& gpu, Device& device)
      : options_(options),
        gpu_(gpu),
        session_(device, chosenSettings(options.config, options.assignments, options.sensor),
                 sourceOptions(options)),
        canvas_(gpu),
        scene_(gpu, device) {
    state_.path = options.source;
    state_.out = options.out;
    state_.headless = options.headless;
    if (!options.source.empty()) session_.open(options.source);
  }

  ~Viewer() { gpu_.waitUntilIdle(); }  // else what is drawn last may still be read when a part goes
  Viewer(const Viewer&) = delete;

  Canvas& canvas() { return canvas_; }
  Session& session() { return session_; }
  PanelState& state() { return state_; }
  bool isProvisional() const { return scene_.isProvisional(); }
  Phase phase() const { return snapshot_.phase; }
  std::string title() const {
    if (snapshot_.source.empty()) return "rosefusion";
    return std::string("rosefusion - ") + toString(snapshot_.phase) + " - " +
           std::to_string(snapshot_.frames) + " frames - " + snapshot_.source;
  }
  std::size_t frames() const { return snapshot_.frames; }

  /// One frame of the panels; what is beneath them is recorded by the function it gives to `show`.
  Requests frame(double seconds, bool finest,
                 const std::function<void(const std::function<void(VkCommandBuffer, VkImage)>&)>& show) {
    snapshot_ = session_.snapshot();
    ImGui_ImplVulkan_NewFrame();
    ImGui::NewFrame();
    const Layout layout = Layout::of(canvas_.width(), canvas_.height(), !snapshot_.depth.empty());
    const Requests requests = drawPanels(layout, snapshot_, session_, view_, state_);
    look(seconds);
    drawOverlay(layout, snapshot_, view_);
    ImGui::Render();
    const Intrinsics camera = view_.intrinsics(layout.surface.width, layout.surface.height, snapshot_.camera);
    show([&](VkCommandBuffer commands, VkImage picture) {
      scene_.record(commands, snapshot_, view_.pose(), camera, finest);
      scene_.place(commands, picture, layout.surface, layout.depth);
    });
    return requests;
  }

 private:
  static SourceOptions sourceOptions(const Options& o) {
    SourceOptions out;
    out.pace = o.realtime ? Pace::Recorded : Pace::AsTaken;
    out.stream = o.stream;
    if (!o.intrinsics.empty())
      out.sequence.intrinsics =
          Intrinsics{0, 0, o.intrinsics[0], o.intrinsics[1], o.intrinsics[2], o.intrinsics[3]};
    return out;
  }

  /// Moves the view; a new model is looked at from behind its first camera.
  void look(double seconds) {
    const Pose tracked = snapshot_.last ? snapshot_.last->world_from_camera : Pose::Identity();
    const bool first = snapshot_.generation != generation_;
    if (first) {
      generation_ = snapshot_.generation;
      view_.frame({0, 0, 2}, 2.2);
    }
    if (first || options_.headless)
      view_.jump(tracked);
    else
      view_.advance(tracked, seconds);
  }

  const Options& options_;
  Gpu& gpu_;
  Session session_;
  Canvas canvas_;
  Scene scene_;
  ViewCamera view_;
  PanelState state_;
  Snapshot snapshot_;
  std::uint64_t generation_ = ~std::uint64_t(0);
};

void runHeadless(const Options& o) {
  Gui gui;
  GpuOptions gpu_options{o.device, o.validation, {}, {}};
  Gpu gpu(gpu_options);
  Device device(gpu.callerDevice());
  Viewer viewer(o, gpu, device);
  for (std::size_t i = 0; i < o.after_frames; ++i) viewer.session().step();
  viewer.session().waitUntilIdle();
  const Snapshot end = viewer.session().snapshot();
  if (end.phase == Phase::Failed) std::rethrow_exception(end.failure);
  viewer.canvas().resize(o.width, o.height);
  ImGui::GetIO().DisplaySize = {float(o.width), float(o.height)};
  // ImGui knows the sizes of some things only from the frame before.
  for (int i = 0; i < 3; ++i)
    viewer.frame(0, true, [&](const auto& beneath) { viewer.canvas().draw(beneath); });
  viewer.canvas().save(o.screenshot);
  if (end.failure) std::rethrow_exception(end.failure);
  if (!gpu.validationMessages().empty())
    throw std::runtime_error("The validation layer complained; see above.");
  std::printf("%s: after %zu frames\n", o.screenshot.c_str(), end.frames);
}

void runWindow(const Options& o) {
  Window window(o.width, o.height);
  Gui gui;
  ImGui_ImplGlfw_InitForVulkan(window.handle(), true);
  {
    Gpu gpu({o.device, o.validation, window.surfaceExtensions(),
             [&](VkInstance instance) { return window.makeSurface(instance); }});
    Device device(gpu.callerDevice());
    Viewer viewer(o, gpu, device);
    Presenter presenter(gpu, window);
    if (o.play) viewer.session().play();
    bool quit = false, screenshot_due = !o.screenshot.empty();
    int shots = 0;
    std::vector<double> times;
    auto last = Clock::now();
    while (!quit && !window.wantsToClose()) {
      // Input is answered at once; otherwise tracking gets the processor.
      constexpr double kPlaying = 0.08, kRefining = 0.05, kResting = 0.25;
      glfwWaitEventsTimeout(viewer.phase() == Phase::Playing || viewer.phase() == Phase::Opening ? kPlaying
                            : viewer.isProvisional()                                             ? kRefining
                                                                                                 : kResting);
      if (!presenter.fit(viewer.canvas())) continue;
      const auto start = Clock::now();
      ImGui_ImplGlfw_NewFrame();
      const std::vector<int> pressed = window.takePressed();
      holdKeys(pressed);
      const double seconds = std::min(0.1, millisecondsSince(last) / 1000);
      last = start;
      const Requests requests = viewer.frame(
          seconds, false, [&](const auto& beneath) { presenter.present(viewer.canvas(), beneath); });
      viewer.state().draw_milliseconds = millisecondsSince(start);
      window.setTitle(viewer.title());
      releaseKeys(pressed, window.handle());
      if (viewer.phase() == Phase::Playing) times.push_back(viewer.state().draw_milliseconds);
      for (const std::string& dropped : window.takeDropped()) {
        viewer.state().path = dropped;
        viewer.session().open(dropped);
      }
      if (requests.screenshot) {
        const auto file = std::filesystem::path(o.out) /
                          (shots == 0 ? "screenshot.png" : "screenshot-" + std::to_string(shots) + ".png");
        try {
          viewer.canvas().save(file);
          viewer.session().say("Saved " + file.string() + ".");
          ++shots;
        } catch (const InputError& error) {  // what was reconstructed outlives a full disk
          viewer.session().say(error.what(), true);
        }
      }
      if (screenshot_due && o.after_frames > 0 && viewer.frames() >= o.after_frames) {
        viewer.canvas().save(o.screenshot);
        screenshot_due = false;
        quit = true;
      }
      quit |= requests.quit;
    }
    if (!times.empty()) {
      std::sort(times.begin(), times.end());
      spdlog::info(
          "the viewer's own frames while tracking: median {:.0f} ms, 95 % under {:.0f} ms, {} of them",
          times[times.size() / 2], times[times.size() * 95 / 100], times.size());
    }
    if (!gpu.validationMessages().empty())
      throw std::runtime_error("The validation layer complained; see above.");
  }
  ImGui_ImplGlfw_Shutdown();
}

int run(int argc, char** argv) {
  Options o;
  CLI::App app{"rosefusion-viewer: watch a room appear while a depth sequence, camera or stream is tracked."};
  app.add_option("SOURCE", o.source,
                 "Folder, .seq file, camera (openni2:) or stream (tcp://*:PORT); may be opened later");
  app.add_option("--config", o.config, "Preset (default, paper) or YAML file")->capture_default_str();
  app.add_option(
      "--sensor", o.sensor,
      "Whose noise the depths have: auto (measured), given, or a camera's name, as of 'rosefusion run'");
  app.add_option("--set", o.assignments, "Change one setting: key=value; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--device", o.device, "Device by index or name");
  app.add_option("--intrinsics", o.intrinsics, "fx,fy,cx,cy in pixels, instead of the source's own")
      ->delimiter(',')
      ->expected(4);
  app.add_option("--secret-key", o.stream.secret_key,
                 "Encrypt network streams: this side's file from 'rosefusion keys'");
  app.add_option("--peer-key", o.stream.peer_keys,
                 "The senders' public keys, one a line; only those may send");
  app.add_option("--silence-limit", o.stream.silence_limit,
                 "End a network stream that is silent for so many seconds; 0: wait for the sender")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--out", o.out, "Where files are saved")->capture_default_str();
  app.add_flag("--play", o.play, "Begin to play at once");
  app.add_flag("--realtime", o.realtime,
               "Play recordings at their own speed, dropping frames as a camera would");
  auto* screenshot =
      app.add_option("--screenshot", o.screenshot, "Save a picture after --after-frames, and end");
  app.add_option("--after-frames", o.after_frames, "Frames before the screenshot")->needs(screenshot);
  app.add_flag("--headless", o.headless, "Without a display; needs --screenshot")->needs(screenshot);
  app.add_option("--width", o.width, "Of the window, pixels")
      ->check(CLI::Range(800, 4096))
      ->capture_default_str();
  app.add_option("--height", o.height, "Of the window, pixels")
      ->check(CLI::Range(600, 4096))
      ->capture_default_str();
  app.add_flag("--validation", o.validation, "Run with the Vulkan validation layer (slow)");
  app.footer(
      "Examples:\n"
      "  rosefusion-viewer my_recording --play\n"
      "  rosefusion-viewer my_recording --screenshot room.png --after-frames 100 --headless");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitBadInput;
  }
  if (o.headless)
    runHeadless(o);
  else
    runWindow(o);
  return kExitOk;
}

}  // namespace
}  // namespace rosefusion::viewer

int main(int argc, char** argv) {
  return rosefusion::guardedMain("rosefusion-viewer", [&] { return rosefusion::viewer::run(argc, argv); });
}
