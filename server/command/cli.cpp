#include "server/command/cli.h"
#include "render/base/utf8.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <string>
#include <vector>

#include "render/base/utf8.h"
#include "server/base/exit_code.h"
#include "server/base/files.h"
#include "server/base/interrupt.h"
#include "server/base/version.h"
#include "server/command/cli_options.h"
#include "server/command/commands.h"
#include "server/options/option_values.h"
#include "server/run/openvdb_format.h"
#include "server/service/access/keys.h"
#include "server/service/serve.h"
#include "server/service/serve_config.h"
#include "server/service/store/store_check.h"

namespace facetless {
namespace {

constexpr const char* kFooter = R"(Examples:
  facetless inspect part.step                          what the file holds, and what was lost
  facetless compare part.step --out report             exact image, tessellation, difference; open report/report.html
  facetless compare part.step --out r --mesh web.glb   is this mesh good enough?
  facetless trade part.step --out trade                what does accuracy cost with a mesh, and what without?
  facetless bench part.step                            how fast is it here?
  facetless serve                                      the same in a browser

Exit codes:
  0   The command succeeded.
  1   The command succeeded, but faces, loops or edges of the file were lost, or a face has no triangle.
  2   The result failed: under --strict or a --fail-* threshold, because the mesh has nothing in common with the model or is
      inside out, because the section planes leave nothing to see, or because the independent check contradicts a certificate.
  3   The images have different sizes.
  4   The input holds nothing usable.
  5   compare wrote the exact half only, because there is no mesh.
  64  The options are wrong.
  70  Facetless has a defect.
  74  The results cannot be written.
Run 'facetless COMMAND --help' for the options of a command.)";

constexpr const char* kRenderFooter = R"(Examples:
  facetless render part.step --out images --view iso --view front --size 1920x1080
  facetless render part.step --out images --projection perspective --edges --background transparent
  facetless render part.step --out images --camera '{"eye":[200,-300,150],"target":[0,0,0],"height":120}'
  facetless render part.step --out images --camera @cameras.json --aov depth,normal,face
  facetless render part.step --out images --shade curvature:kind=gaussian
  facetless render car.step --out images --parts wheel --hide "*bolt*" --explode 0.5 --color part --axes --scale-bar
  facetless render part.step --out images --view front --view top --view iso --sheet --turntable 36

The command writes NAME.direct.png, NAME.depth.tif (float64, mm), NAME.aov.exr if --aov is given, report.json and report.html
to the directory of --out, and prints the path of report.json.

A voxel file (.oct, .vxl, .raw, .nrrd, .vti, .vdb, .tif, or a folder of slices) is rendered to one picture, and the command
prints JSON about it:
  facetless render terrain.vxl --out terrain.png --size 800x600 --point-light 100,50,300
  facetless render part.oct --out part.png --view front --walk kd-shortstack:4 --ambient 0.2)";

constexpr const char* kCompareFooter = R"(Examples:
  facetless compare part.step --out report
  facetless compare part.step --out report --deflection 1e-4 --view iso --view top
  facetless compare part.step --out report --mesh exported.glb --fail-deviation-mm 0.05
  facetless compare part.step --out report --mesh exported.stl --mesh-unit in --mesh-up y
  facetless compare part.step --out report --mesh-timeout 60      stop meshing after 60 s and report the exact half

The command writes, for each view, NAME.direct.png, NAME.baseline.png, NAME.difference.png, NAME.depth.tif and
NAME.baseline-depth.tif, and also report.json and report.html, to the directory of --out. It prints the path of report.json.)";

constexpr const char* kTradeFooter = R"(Examples:
  facetless trade part.step --out trade
  facetless trade part.step --out trade --max-error-mm 0.05       which deflection keeps the error under 0.05 mm?
  facetless trade part.step --out trade --deflections 1e-2,1e-3,1e-4 --angles 20 --view iso --view top
  facetless trade part.step --out trade --budget-seconds 300      allow more time for finer meshes

The command measures time, memory and the error against the certified exact image, for both tracers at many accuracies. It
writes report.json, report.html, the plots trade-time and trade-memory (.svg, .png) and NAME.direct.png to the directory of
--out. Standard output gets the path of report.json; standard error gets a table and the answers. docs/trade.md describes the
method.)";

constexpr const char* kVoxelizeFooter = R"(Examples:
  facetless voxelize part.step --resolution 256 --out part.nrrd
  facetless voxelize part.step --pitch-mm 0.1 --fill conservative --out part.vti      thin walls do not vanish
  facetless voxelize part.step --resolution 1024 --out part.oct
  facetless compare part.step --out report --with voxels:256                          the voxels beside the exact image

The suffix selects the format: .oct, .vxl, .raw, .nrrd, .vti, .vdb or .tif; a name that ends with / is a folder of PNG slices.
The command prints what it made, and how much of it is proven, as JSON. docs/voxels.md describes the fills and the formats.)";

constexpr const char* kConvertFooter = R"(Examples:
  facetless convert part.vxl --out part.oct
  facetless convert part.nrrd --out slices/ --axis y                PNG files, one for each y
  facetless convert scan/ --out scan.vti --pitch-mm 0.5 --threshold 90
  facetless convert part.oct --out part.vdb                         for Blender and Houdini

The suffix selects the format, as for voxelize; a folder has slices, PNG or TIFF files in the order of the numbers in their
names. The command prints what it made as JSON, and on standard error what the format cannot hold. docs/voxels.md describes
the formats.)";

constexpr const char* kMethodsFooter = R"(Examples:
  facetless methods                                      all methods, their sources, and what they do not promise
  facetless methods part.step                            what each costs on this part, and what it gets wrong
  facetless methods part.step --out marked --view front --methods martin,bezier-clipping,certified
  facetless render part.step --out images --method robust-clipping

On a file, the command traces each view with each method on one thread, and prints a table. With --out, it also writes
methods.json, and VIEW.NAME.png: the certified picture in grey, on which lost hits of the method are vermilion,
invented ones blue, imprecise ones yellow and unresolved ones purple. docs/methods.md describes the methods.)";

constexpr const char* kBenchFooter = R"(Examples:
  facetless bench part.step other.igs                    the performance aims, the measured values, and each file
  facetless bench parts/*.step --json bench.json --plot bench.svg --markdown
  facetless bench --published                            the tables of the published papers, on this machine
  facetless bench --published part.step                  also compare acceleration structures over this file's leaves
  facetless bench --structures part.step                 structures for rays in any direction, on boxes and on this file
  facetless bench --openvdb part.step                    voxels of this file, and rays through them, beside OpenVDB's

The two sides of each comparison are measured in turn, and their medians are reported; the machine should otherwise be idle.
docs/performance.md has results and explains them.)";

constexpr const char* kMeshFooter = R"(Examples:
  facetless mesh part.step --out part.glb
  facetless mesh part.step --out part.glb --deflection-mm 0.01 --angular 10
  facetless mesh part.step --out part.stl --deflection-mm 0.05 --angular 5
  facetless mesh part.step --out part.obj        colours go to part.mtl

The suffix selects the format: .glb, .stl (binary), .obj or .3mf. The command prints the path on standard output; on standard
error it reports the number of triangles and whether the mesh is watertight.)";

constexpr const char* kInspectFooter = R"(Example:
  facetless inspect part.step | jq '.model.faces_skipped')";

constexpr const char* kContinuityFooter = R"(Examples:
  facetless continuity part.step | jq '.continuity.counts'
  facetless continuity part.step | jq '.continuity.worst.G1[:10]'

For every edge that two faces share, the command reports the gap between the faces, the angle at which they meet and the jump
of the curvature, worst first. docs/inspection.md describes the method.)";

constexpr const char* kRegressFooter = R"(Examples:
  facetless regress manifest.json --update          write the reference images
  facetless regress manifest.json --out failures    compare with them; write pictures of failures to failures/

docs/regression.md describes the manifest. The verdict is JSON on standard output; exit code 0 means that everything passed.)";

constexpr const char* kServeFooter = R"(Examples:
  facetless serve
  facetless keys create /var/lib/facetless --name anna && facetless serve --listen 0.0.0.0:8080 --data /var/lib/facetless --jobs 4
  facetless serve --max-store 50000 --max-age 30          delete what was not used for a month
  facetless serve --config /etc/facetless.toml --ops-listen 127.0.0.1:9090 --log json
  FACETLESS_SERVE_JOBS=4 facetless serve --print-config   show every option and where its value comes from
  curl -F file=@part.step http://127.0.0.1:8080/v1/comparisons

If other hosts can reach the address, the service requires keys (facetless keys create). The service does not speak TLS; put it
behind a proxy that does. docs/api.md documents the API.)";

constexpr const char* kKeysFooter = R"(Examples:
  facetless keys create /var/lib/facetless --name anna --rate 600 --quota 20000
  facetless keys list /var/lib/facetless
  facetless keys revoke /var/lib/facetless 0f3a5c7e9b1d2f4a
  curl -H "Authorization: Bearer $KEY" -F file=@part.step http://127.0.0.1:8080/v1/comparisons)";

constexpr const char* kStoreCheckFooter = R"(Example:
  facetless store check /var/lib/facetless | jq '.faults'

Exit codes: 0 the database and the files agree; 1 they do not, and "faults" lists the differences; 64 the directory is in use, or
is not a data directory.
After a crash, orphaned files and files in tmp/ are reported as faults, too; the service removes them at its next start.)";

CLI::App* AddFileCommand(CLI::App& app, const std::string& name, const std::string& help, const char* footer,
                         CommandArguments& arguments) {
  CLI::App* command = app.add_subcommand(name, help);
  command->footer(footer);
  command->add_option("FILE", arguments.file, "STEP, IGES or BREP file")->required();
  return command;
}

CLI::App* AddMethodsCommand(CLI::App& app, CommandArguments& arguments) {
  CLI::App* methods = app.add_subcommand(
      "methods", "List the methods that intersect rays with surfaces, or compare them on a file");
  methods->footer(kMethodsFooter);
  methods->add_option("FILE", arguments.file, "STEP, IGES or BREP file; without one, the methods are listed");
  methods->add_option("--out", arguments.out, "Directory for pictures with marked errors, and methods.json")
      ->type_name("DIR");
  return methods;
}

CLI::App* AddRenderCommand(CLI::App& app, CommandArguments& arguments) {
  CLI::App* render =
      AddFileCommand(app, "render", "Render the exact surfaces, or a voxel file", kRenderFooter, arguments);
  render
      ->add_option("--out", arguments.out,
                   "Directory for the results, created if absent; of a voxel file, the picture NAME.png")
      ->required()
      ->type_name("DIR");
  return render;
}

CLI::App* AddVoxelizeCommand(CLI::App& app, CommandArguments& arguments) {
  CLI::App* voxelize = AddFileCommand(
      app, "voxelize", "Write the voxels of the exact solids: .oct, .nrrd, .vti, .vdb, slices …",
      kVoxelizeFooter, arguments);
  voxelize->add_option("--out", arguments.out, "The file to write; its suffix selects the format")
      ->required()
      ->type_name("FILE");
  return voxelize;
}

CLI::App* AddBenchCommand(CLI::App& app, CommandArguments& arguments) {
  CLI::App* bench =
      app.add_subcommand("bench", "Measure performance on files, or reproduce the published tables");
  bench->footer(kBenchFooter);
  AddBenchOptions(bench, arguments);
  return bench;
}

CLI::App* AddConvertCommand(CLI::App& app, CommandArguments& arguments) {
  CLI::App* convert = app.add_subcommand("convert", "Write a file of voxels in another format (JSON)");
  convert->footer(kConvertFooter);
  convert->add_option("VOXELS", arguments.file, "File of voxels, or folder of slices")->required();
  convert->add_option("--out", arguments.out, "The file to write; its suffix selects the format")
      ->required()
      ->type_name("FILE");
  return convert;
}

CLI::App* AddStoreCheckCommand(CLI::App& app, CommandArguments& arguments) {
  CLI::App* store = app.add_subcommand("store", "Check the data directory of the service");
  store->require_subcommand(1);
  CLI::App* store_check = store->add_subcommand(
      "check", "Verify that the database and the files agree, while the service is stopped (JSON)");
  store_check->footer(kStoreCheckFooter);
  store_check->add_option("DIR", arguments.file, "Data directory")->required();
  return store_check;
}

// The subcommands of keys.
struct KeyCommands {
  CLI::App *create = nullptr, *list = nullptr, *revoke = nullptr;
};

KeyCommands AddKeyCommands(CLI::App& app, KeyArguments& key) {
  CLI::App* keys = app.add_subcommand("keys", "Manage access keys (JSON); works while the service runs");
  keys->require_subcommand(1);
  keys->footer(kKeysFooter);
  KeyCommands commands;
  commands.create = keys->add_subcommand("create", "Create a key and print it; it cannot be shown again");
  commands.list = keys->add_subcommand("list", "List the keys");
  commands.revoke = keys->add_subcommand("revoke", "Revoke a key");
  for (CLI::App* command : {commands.create, commands.list, commands.revoke})
    command->add_option("DIR", key.directory, "Data directory of the service")->required();
  commands.revoke->add_option("ID", key.id, "Id of the key")->required();
  commands.create->add_option("--name", key.name, "Readable name of the key's owner")
      ->required()
      ->type_name("NAME");
  commands.create->add_option("--scopes", key.scopes, "Scopes of the key: read, submit, admin")
      ->type_name("LIST")
      ->capture_default_str();
  commands.create->add_option("--rate", key.rate, "Requests allowed per minute (0: no limit)")
      ->type_name("N")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  commands.create
      ->add_option("--quota", key.quota_mb, "Megabytes that the service stores for this key (0: no limit)")
      ->type_name("MB")
      ->check(CLI::Range(0, 1 << 30))
      ->capture_default_str();
  return commands;
}

// Runs a command with the collected options.
int Dispatch(int (*command)(const CommandArguments&), CommandArguments& arguments,
             OptionCollector& collected) {
  auto json = collected.CollectedOptions();
  if (!json) return PrintError(json.error());
  auto options = ParseOptions(json.value());
  if (!options) return PrintError(options.error());
  arguments.options = std::move(options).value();
  for (const auto& option : json.value().items()) arguments.given.push_back(option.key());
  return command(arguments);
}

int RunServe(ServeConfig& config) {
  auto options = config.Resolve();
  if (!options) return PrintError(options.error());
  if (!config.print()) return Serve(options.value());
  std::printf("%s\n", JsonText(config.Description()).c_str());
  return kExitDone;
}

int NoCommand(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  std::fprintf(stderr, "facetless: there is no command \"%s\"; the commands are %s\n",
               Printable(word).c_str(), Joined(names).c_str());
  return kExitUsage;
}

}  // namespace

int RunCommandLine(int argc, char** argv) {
  InstallInterruptHandlers();
  AddOpenVdbFormat();
  CLI::App app{
      "Facetless renders CAD models from their exact surfaces, and shows the errors of a tessellation.",
      "facetless"};
  app.set_version_flag("--version", "facetless " + Version());
  app.require_subcommand(1);
  app.footer(kFooter);
  CommandArguments arguments;
  OptionCollector options;

  // Add the commands.
  CLI::App* inspect =
      AddFileCommand(app, "inspect", "List the contents of a file and what the import lost (JSON)",
                     kInspectFooter, arguments);
  CLI::App* continuity = AddFileCommand(
      app, "continuity", "Measure how smoothly neighbouring faces meet (JSON)", kContinuityFooter, arguments);
  CLI::App* render = AddRenderCommand(app, arguments);
  CLI::App* mesh = AddFileCommand(app, "mesh", "Write a tessellation: glTF binary, STL, OBJ or 3MF",
                                  kMeshFooter, arguments);
  CLI::App* compare =
      AddFileCommand(app, "compare", "Render exact surfaces and a mesh, and report the difference",
                     kCompareFooter, arguments);
  CLI::App* trade = AddFileCommand(app, "trade", "Measure the speed of both tracers against their accuracy",
                                   kTradeFooter, arguments);
  CLI::App* methods = AddMethodsCommand(app, arguments);
  CLI::App* voxelize = AddVoxelizeCommand(app, arguments);
  CLI::App* convert = AddConvertCommand(app, arguments);
  CLI::App* bench = AddBenchCommand(app, arguments);
  CLI::App* regress = app.add_subcommand("regress", "Compare renderings with reference images, for CI");
  regress->footer(kRegressFooter);
  regress->add_option("MANIFEST", arguments.file, "JSON file with the models, views and tolerances")
      ->required();
  CLI::App* serve_command = app.add_subcommand("serve", "Serve the HTTP API and a page for browsers");
  serve_command->footer(kServeFooter);
  ServeConfig serve(serve_command);
  KeyArguments key;
  const KeyCommands keys = AddKeyCommands(app, key);
  CLI::App* store_check = AddStoreCheckCommand(app, arguments);

  // Add their options.
  for (CLI::App* command : {compare, trade})
    command->add_option("--out", arguments.out, "Directory for the results; created if absent")
        ->required()
        ->type_name("DIR");
  mesh->add_option("--out", arguments.out,
                   "The file to write; its suffix selects the format: .glb, .stl, .obj or .3mf")
      ->required()
      ->type_name("FILE");
  regress->add_flag("--update", arguments.update,
                    "Write the reference images instead of comparing with them");
  regress->add_option("--out", arguments.out, "Directory for pictures of the views that failed")
      ->type_name("DIR");
  for (const auto& [command, bit] : {std::pair{inspect, kInspect},
                                     {continuity, kContinuity},
                                     {render, kRender},
                                     {mesh, kMesh},
                                     {compare, kCompare},
                                     {trade, kTrade},
                                     {methods, kMethods},
                                     {voxelize, kVoxelize},
                                     {convert, kConvert},
                                     {bench, kBench},
                                     {regress, kRegress}}) {
    AddOptions(command, bit, options);
    command->add_flag("--progress", arguments.progress,
                      "Print progress even if standard error is not a terminal");
  }

  // Parse the command line. Help and version end with exit code 0, wrong options with 64.
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (const std::vector<std::string> words = app.remaining();
        app.get_subcommands().empty() && !words.empty() && !words[0].starts_with('-'))
      return NoCommand(app, words[0]);
    return app.exit(error) == 0 ? kExitDone : kExitUsage;
  }
  if (*serve_command) return RunServe(serve);
  if (*keys.create) return CreateKeyCommand(key);
  if (*keys.list) return ListKeysCommand(key);
  if (*keys.revoke) return RevokeKeyCommand(key);
  if (*store_check) return StoreCheckCommand(arguments.file);
  for (const auto& [command, run] : {std::pair{inspect, &InspectCommand},
                                     {continuity, &ContinuityCommand},
                                     {render, &RenderCommand},
                                     {mesh, &MeshCommand},
                                     {compare, &CompareCommand},
                                     {trade, &TradeCommand},
                                     {methods, &MethodsCommand},
                                     {voxelize, &VoxelizeCommand},
                                     {convert, &ConvertCommand},
                                     {bench, &BenchCommand},
                                     {regress, &RegressCommand}}) {
    if (*command) return Dispatch(run, arguments, options);
  }
  return kExitUsage;
}

}  // namespace facetless
