// rosefusion record: a camera's frames, or any other source's, into a folder that run takes.
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
#include "host/run/recording.h"

namespace rosefusion::cli {
namespace {

struct RecordOptions {
  SourceArguments source;
  std::string out, json;
  bool no_colour = false;
};

void record(const RecordOptions& o) {
  RecordingWriter::requireUsable(o.out);
  catchInterrupts();
  const auto source = openSource(o.source, !o.no_colour).frames;
  if (!source) throw ExitCode(kExitInterrupted);
  const SequenceInfo& info = source->info();
  spdlog::info("{}: {}; Ctrl-C ends the recording", info.path.string(), info.format);
  RecordingWriter writer(o.out, info);
  std::size_t dropped = 0, left_out = 0;
  SourceState state = SourceState::Frame;
  {
    Progress progress("frames");
    const std::size_t most = o.source.selection.max_frames, expected = source->expectedFrames();
    SourceFrame frame;
    try {
      while (!most || writer.frames() < most) {
        state = source->next(frame, interrupted);
        if (state != SourceState::Frame) break;
        dropped += frame.dropped;
        if (!frame.problem.empty()) spdlog::warn("{}", frame.problem);
        if (!frame.usable || !writer.add(frame.frame)) ++left_out;
        progress.update(writer.frames(), most ? most : expected);
      }
    } catch (const InputError&) {  // an unplugged camera, or a full disk, which has room for a name
      if (writer.frames() == 0) throw;
      writer.finish();
      spdlog::warn("{}: holds the {} frames that came before.", o.out, writer.frames());
      throw;
    }
  }
  if (writer.frames() == 0) throw InputError(o.source.source + ": no frame came that could be recorded.");
  writer.finish();
  std::fprintf(o.json == "-" ? stderr : stdout, "%zu frames recorded, %zu dropped, %zu left out.\n  %s\n",
               writer.frames(), dropped, left_out, o.out.c_str());
  writeJson(
      o.json,
      nlohmann::ordered_json{{"frames", writer.frames()}, {"dropped", dropped}, {"left_out", left_out}}.dump(
          2));
  // A camera has no other end than Ctrl-C.
  if (state == SourceState::Stopped && !isLiveSource(o.source.source)) throw ExitCode(kExitInterrupted);
}

}  // namespace

void addRecordCommand(CLI::App& app) {
  auto o = std::make_shared<RecordOptions>();
  CLI::App* command =
      app.add_subcommand("record", "Record a camera, or convert any source, to a folder of PNGs");
  o->source.addTo(*command);
  command->add_option("OUT", o->out, "Folder to make: depth/, rgb/ and sequence.yaml")->required();
  command->add_flag("--no-colour,--no-color", o->no_colour, "Depth alone, a third of the room");
  command->add_option("--json", o->json, "Also write the counts here; '-': standard output");
  command->footer(
      "Depth is kept bit for bit. The folder has its name once it is complete; Ctrl-C completes it.\n"
      "Examples:\n"
      "  rosefusion record openni2: desk\n"
      "  rosefusion record walk.bag walk --start 30\n"
      "  rosefusion run desk\n"
      "Exit codes: 0 recorded, 2 bad input, 130 interrupted (what there is of a recording is kept).");
  command->callback([o] { record(*o); });
}

}  // namespace rosefusion::cli
