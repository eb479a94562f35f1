// Drags a path onto a window as a file manager does: drop WINDOW PATH. It is the source of the XDND protocol,
// version 5; exit code 0 when the window says that it took the path.
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <poll.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

constexpr long kVersion = 5;
constexpr int kPatience = 20'000;  // milliseconds for each answer

struct Source {
  Display* display = XOpenDisplay(nullptr);
  Window window = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
  Window target;
  std::string uri;

  Atom atom(const char* name) const { return XInternAtom(display, name, False); }

  void tell(const char* message, long a, long b, long c, long d) const {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target;
    event.xclient.message_type = atom(message);
    event.xclient.format = 32;
    const long data[5] = {static_cast<long>(window), a, b, c, d};
    for (int i = 0; i < 5; ++i) event.xclient.data.l[i] = data[i];
    XSendEvent(display, target, False, NoEventMask, &event);
    XFlush(display);
  }

  /// Hands the path over to whoever asks for the selection.
  void answer(const XSelectionRequestEvent& request) const {
    XChangeProperty(display, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(uri.data()), static_cast<int>(uri.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display, request.requestor, False, NoEventMask, &event);
    XFlush(display);
  }

  /// The first number of `message`'s data after the window.
  long waitFor(const char* message) const {
    for (;;) {
      pollfd readable{ConnectionNumber(display), POLLIN, 0};
      if (!XPending(display) && poll(&readable, 1, kPatience) <= 0) {
        std::fprintf(stderr, "drop: the window never answered with %s\n", message);
        std::exit(1);
      }
      while (XPending(display)) {
        XEvent event;
        XNextEvent(display, &event);
        if (event.type == SelectionRequest) answer(event.xselectionrequest);
        if (event.type == ClientMessage && event.xclient.message_type == atom(message))
          return event.xclient.data.l[1];
      }
    }
  }
};

}  // namespace

int main(int count, char** texts) {
  if (count != 3 || !std::getenv("DISPLAY")) return 2;
  Source source;
  source.target = std::strtoul(texts[1], nullptr, 0);
  source.uri = std::string("file://") + texts[2] + "\r\n";
  XSetSelectionOwner(source.display, source.atom("XdndSelection"), source.window, CurrentTime);
  source.tell("XdndEnter", kVersion << 24, static_cast<long>(source.atom("text/uri-list")), 0, 0);
  source.tell("XdndPosition", 0, 200 << 16 | 200, CurrentTime,
              static_cast<long>(source.atom("XdndActionCopy")));
  const bool accepts = source.waitFor("XdndStatus") & 1;
  if (!accepts) return 1;
  source.tell("XdndDrop", 0, CurrentTime, 0, 0);
  return source.waitFor("XdndFinished") & 1 ? 0 : 1;
}
