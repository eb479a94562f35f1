// What is drawn with ImGui: controls, figures, and the lines over the surface.
#pragma once
#include <string>

#include "apps/viewer/image.h"
#include "apps/viewer/session.h"
#include "apps/viewer/view_camera.h"

namespace rosefusion::viewer {

/// Where things lie in the window, in pixels; nothing overlaps whatever its size.
struct Layout {
  Rectangle surface, depth, controls, figures;
  static Layout of(int width, int height, bool has_depth);
};

/// What the user asked for that is not the session's business.
struct Requests {
  bool screenshot = false, quit = false;
};

/// The panels' own state between frames.
struct PanelState {
  std::string path;           ///< in the field
  std::filesystem::path out;  ///< where files are saved
  std::string settings_filter;
  bool settings_open = false, focus_filter = false, expert_settings = false;
  int iteration = -1;            ///< of the swarm that is shown; -1: the last
  double draw_milliseconds = 0;  ///< of the viewer's own last frame
  bool headless = false;         ///< without what differs from run to run
};

/// Between ImGui's NewFrame and Render. Draws everything, moves the view and commands the session.
Requests drawPanels(const Layout& layout, const Snapshot& snapshot, Session& session, ViewCamera& view,
                    PanelState& state);
/// Trajectory, camera and colour bar over the surface, for the pose that it is drawn from.
void drawOverlay(const Layout& layout, const Snapshot& snapshot, const ViewCamera& view);

/// Font and colours.
void setUpStyle();

}  // namespace rosefusion::viewer
