// SPDX-License-Identifier: MIT
// `sheaf`: errors become one line on stderr and an exit code here, and nowhere else.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <new>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"

namespace {

volatile std::sig_atomic_t caught_signal = 0;
extern "C" void on_signal(int number) { caught_signal = number; }

int report(sheaf::Progress* progress, int code, const std::string& text) {
  if (progress != nullptr)
    progress->error(code, text);
  else
    std::fprintf(stderr, "sheaf: %s\n", text.c_str());
  return code;
}

// CLI11 repeats arguments whole.
std::string shown(std::string message, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    for (const std::string& text : {argument, argument.substr(argument.find('=') + 1)}) {
      const std::size_t at = message.find(text);
      if (text.size() > sheaf::quote_limit && at != std::string::npos)
        message.replace(at, text.size(), sheaf::quote(text));
    }
  }
  return sheaf::one_line(message);
}

int run(int argc, char** argv, std::unique_ptr<sheaf::Progress>& progress) {
  CLI::App app{"Sheaf renders animated glTF scenes by Whitted ray tracing over a coherent ray-space hierarchy",
               "sheaf"};
  app.set_version_flag("--version", std::string("sheaf ") + SHEAF_VERSION);
  app.require_subcommand(1);
  auto* render = app.add_subcommand("render", "render frames to OpenEXR");
  const sheaf::RenderLine line(*render);
  std::string scene, scene_name, variant;
  bool inspect_json = false, devices_json = false, options_json = false;
  auto* inspect = app.add_subcommand("inspect", "what a scene holds, what it needs, what will be left out and why");
  inspect->add_option("scene", scene, "a .glb or .gltf file")->required();
  inspect->add_option("--scene-name", scene_name, "which glTF scene: name or index");
  inspect->add_option("--variant", variant, "which variant of the materials: name or index");
  inspect->add_flag("--json", inspect_json);
  auto* devices = app.add_subcommand("devices", "Vulkan devices and what each can do");
  devices->add_flag("--json", devices_json);
  auto* settings = app.add_subcommand("options", "every setting of render: its type, range, choices, default and unit");
  settings->add_flag("--json", options_json);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return report(nullptr, static_cast<int>(sheaf::ErrorKind::usage),
                  shown(error.what(), argc, argv) + " (see sheaf --help)");
  }
  if (devices->parsed()) return sheaf::run_devices(devices_json);
  if (settings->parsed()) return sheaf::run_options(options_json);
  if (inspect->parsed()) return sheaf::run_inspect(scene, scene_name, variant, inspect_json);
  progress = std::make_unique<sheaf::Progress>(line.progress());
  sheaf::RenderOptions options = line.options();
  return sheaf::run_render(options, *progress);
}

}  // namespace

namespace sheaf {
int interrupted() { return caught_signal; }
void watch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}
}  // namespace sheaf

int main(int argc, char** argv) {
  std::unique_ptr<sheaf::Progress> progress;
  try {
    return run(argc, argv, progress);
  } catch (const sheaf::Error& error) {
    return report(progress.get(), error.exit_code(), error.what());
  } catch (const std::bad_alloc&) {
    return report(progress.get(), static_cast<int>(sheaf::ErrorKind::limit), "out of memory");
  } catch (const std::exception& error) {
    return report(progress.get(), static_cast<int>(sheaf::ErrorKind::device), error.what());
  }
}
