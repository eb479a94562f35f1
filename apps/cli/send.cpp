// rosefusion send: the light end of a stream; reads a camera or a recording, compresses, sends.
// rosefusion keys: what encrypts it.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/progress.h"
#include "apps/cli/source_options.h"
#include "host/core/error.h"

namespace rosefusion::cli {
namespace {

struct SendOptions {
  SourceArguments source;
  std::string endpoint;
  std::string json;
  bool colour = false;
};

void report(const SendOptions& o, const StreamSender::Counts& c, std::uint64_t passed_over) {
  const double ratio = c.sent_bytes ? double(c.raw_bytes) / double(c.sent_bytes) : 0;
  const double milliseconds = c.frames ? 1000 * c.compress_seconds / double(c.frames) : 0;
  const std::uint64_t meant = c.frames - c.dropped;
  const std::string frames = c.arrived == meant ? fmt::format("{} frames sent", meant)
                                                : fmt::format("{} of {} frames arrived", c.arrived, meant);
  std::fprintf(o.json == "-" ? stderr : stdout,
               "%s: %.1f MB, %.1f:1 compressed, %.2f ms a frame to compress; %llu dropped, %llu sent "
               "again.\n",
               frames.c_str(), double(c.arrived_bytes) / 1e6, ratio, milliseconds,
               static_cast<unsigned long long>(c.dropped) + passed_over,
               static_cast<unsigned long long>(c.resent));
  writeJson(o.json, nlohmann::ordered_json{{"frames", c.arrived},
                                           {"dropped", c.dropped + passed_over},
                                           {"sent_again", c.resent},
                                           {"bytes", c.arrived_bytes},
                                           {"compression", ratio},
                                           {"compress_ms", milliseconds}}
                        .dump(2));
}

void send(const SendOptions& o) {
  if (!isStreamEndpoint(o.endpoint))
    throw InputError(o.endpoint + ": give the receiver's address, such as tcp://192.168.1.20:5555.");
  catchInterrupts();
  const auto source = openSource(o.source, o.colour).frames;
  if (!source) throw ExitCode(kExitInterrupted);
  SequenceInfo info = source->info();
  info.frames = source->expectedFrames();
  StreamOptions options = o.source.stream;
  options.live = o.source.realtime || isLiveSource(o.source.source);
  StreamSender sender(o.endpoint, info, options);
  spdlog::info("{}: {}; to {}", info.path.string(), info.format, o.endpoint);

  bool whole = true;
  std::uint64_t passed_over = 0;
  {
    Progress progress("frames");
    SourceFrame frame;
    std::size_t done = 0;
    const std::size_t most = o.source.selection.max_frames;
    while (whole && (!most || done < most)) {
      const SourceState state = source->next(frame, interrupted);
      if (state != SourceState::Frame) {
        whole = state == SourceState::End;
        break;
      }
      passed_over += frame.dropped;
      if (!frame.problem.empty()) spdlog::warn("{}", frame.problem);
      if (frame.usable) whole = sender.send(frame.frame, interrupted);
      progress.update(++done, info.frames);
    }
    // A camera that was stopped by Ctrl-C has ended all the same.
    const bool say_end = whole || options.live;
    const bool told = say_end && sender.finish(interrupted);
    whole = whole && told;
  }
  report(o, sender.counts(), passed_over);
  if (!whole) throw ExitCode(kExitInterrupted);
}

}  // namespace

void addSendCommand(CLI::App& app) {
  auto o = std::make_shared<SendOptions>();
  CLI::App* command =
      app.add_subcommand("send", "Send a camera's or a recording's frames to 'run' on another machine");
  o->source.addTo(*command);
  command->add_option("ENDPOINT", o->endpoint, "tcp://HOST:PORT, where 'rosefusion run tcp://*:PORT' listens")
      ->required();
  command->add_flag("--colour", o->colour, "Colour images too; they take some ten times the room of depth");
  command->add_option("--json", o->json, "Also write counts and compression here; '-': standard output");
  command->footer(
      "Recordings arrive whole, through broken connections too. Of cameras, and with --realtime, the newest "
      "frame is\n"
      "sent and what the network cannot carry is dropped.\n"
      "Examples:\n"
      "  rosefusion send openni2: tcp://192.168.1.20:5555\n"
      "  rosefusion send my_recording tcp://localhost:5555 --secret-key camera.secret --peer-key "
      "server.public\n"
      "Exit codes: 0 all arrived, 2 bad input or refused, 130 interrupted.");
  command->callback([o] { send(*o); });
}

void addKeysCommand(CLI::App& app) {
  auto name = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("keys", "Make a pair of keys for encrypted network streams");
  command->add_option("NAME", *name, "Writes NAME.secret and NAME.public")->required();
  command->footer(
      "Each side has a pair, keeps its secret file and gives the public one to the other.\n"
      "Example:\n"
      "  rosefusion keys server; rosefusion keys camera\n"
      "  rosefusion run tcp://*:5555 --secret-key server.secret --peer-key camera.public\n"
      "  rosefusion send my_recording tcp://localhost:5555 --secret-key camera.secret --peer-key "
      "server.public");
  command->callback([name] {
    makeKeys(*name);
    std::printf("  %s.secret\n  %s.public\n", name->c_str(), name->c_str());
  });
}

}  // namespace rosefusion::cli
