#include "import/source_file.h"

#include <openssl/evp.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "import/step_entities.h"

namespace facetless {
namespace {

// The header is searched within this many bytes, because some writers put comments before it.
constexpr std::size_t kHeaderBytes = 4096;

std::string Sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
  unsigned int size = 0;
  EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr);
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    constexpr char kHex[] = "0123456789abcdef";
    text += kHex[digest[i] >> 4];
    text += kHex[digest[i] & 15];
  }
  return text;
}

bool Contains(std::string_view text, std::string_view what) {
  return text.find(what) != std::string_view::npos;
}

bool StartsWithNoCase(std::string_view text, std::string_view what) {
  return text.size() >= what.size() && std::equal(what.begin(), what.end(), text.begin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

// Returns a sentence that says what a file is that is no CAD file, with the remedy; empty if the format is
// unknown.
std::string Foreign(const std::string& name, std::string_view bytes) {
  const std::string_view head = bytes.substr(0, kHeaderBytes);
  const std::string_view text = head.substr(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
  const std::string mesh =
      " is a mesh, which has no exact surfaces; pass it with --mesh, beside the CAD model that it was made "
      "from.";
  if (head.substr(0, 4) == "glTF") return name + " (glTF)" + mesh;
  if (text.substr(0, 1) == "{" && Contains(head, "\"asset\"")) return name + " (glTF)" + mesh;
  if (text.substr(0, 5) == "solid" && Contains(head, "facet")) return name + " (STL)" + mesh;
  if (bytes.size() >= 84) {
    // In a binary STL file, the number at byte 80 says how many triangles of 50 bytes follow.
    std::uint32_t triangles = 0;
    for (int i = 3; i >= 0; --i) triangles = triangles << 8 | static_cast<unsigned char>(bytes[80 + i]);
    if (triangles > 0 && bytes.size() == 84 + std::uint64_t{triangles} * 50) return name + " (STL)" + mesh;
  }
  if (text.substr(0, 3) == "ply") return name + " (PLY)" + mesh;
  if (text.substr(0, 2) == "v " || Contains(head, "\nv ")) return name + " (OBJ)" + mesh;
  if (StartsWithNoCase(text, "<!doctype html") || StartsWithNoCase(text, "<html"))
    return name + " is a web page, not a CAD file; was the download redirected to a sign-in or error page?";
  if (text.starts_with("version https://git-lfs.github.com/spec/"))
    return name +
           " is a Git LFS pointer, which stands for the file; fetch the file itself with \"git lfs pull\".";
  if (head.substr(0, 2) == "PK") return name + " is a ZIP archive; unpack it and pass the CAD file inside.";
  if (head.substr(0, 2) == "\x1f\x8b") return name + " is compressed with gzip; unpack it first.";
  return {};
}

// Returns whether the file consists of IGES records: 80 columns each, with the section's letter in column 73.
// The first letter is S.
bool LooksLikeIges(std::string_view bytes) {
  const std::string_view line = bytes.substr(0, bytes.find_first_of("\r\n"));
  return line.size() >= 73 && line.size() <= 81 && (line[72] == 'S' || line[72] == 'F');
}

std::optional<CadFormat> Recognise(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, kHeaderBytes);
  if (Contains(head, "ISO-10303-21")) return CadFormat::kStep;
  if (Contains(head, "DBRep_DrawableShape") || Contains(head, "CASCADE Topology")) return CadFormat::kBrep;
  if (LooksLikeIges(bytes)) return CadFormat::kIges;
  return {};
}

// Converts the line ends CR and CR LF to LF. Returns whether there was a CR without a following LF.
bool UnifyLineEnds(std::string& bytes) {
  bool lone = false;
  std::string out;
  out.reserve(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (bytes[i] != '\r') {
      out += bytes[i];
    } else {
      const bool pair = i + 1 < bytes.size() && bytes[i + 1] == '\n';
      lone = lone || !pair;
      if (!pair) out += '\n';
    }
  }
  bytes = std::move(out);
  return lone;
}

// Returns the contexts of styles, which OpenCASCADE 7.6 does not read.
std::vector<StepStyleContext> StyleContexts(std::string_view bytes) {
  constexpr std::string_view kKeyword = "CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM";
  constexpr std::size_t kContexts = 4;  // index of the contexts among the attributes
  std::vector<StepStyleContext> styles;
  if (bytes.find(kKeyword) == std::string_view::npos) return styles;
  const StepEntities entities(bytes);
  for (const StepEntity& entity : entities.all()) {
    if (entity.keyword != kKeyword) continue;
    const std::optional<StepRecord> record = entities.Record(entity);
    if (!record || record->parts.empty() || record->parts[0].values.size() <= kContexts) continue;
    StepStyleContext style;
    style.item = entity.id;
    for (const StepValue& value : record->parts[0].values[kContexts].items) {
      if (value.IsReference()) style.contexts.push_back(value.reference);
    }
    styles.push_back(std::move(style));
  }
  return styles;
}

// Reads the bytes of a file, which must be a regular file and not empty.
Result<std::string> ReadSource(const std::string& path, const std::string& name) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    return Error{ErrorCode::kFileUnreadable, path + " does not exist or may not be read."};
  if (!S_ISREG(status.st_mode)) return Error{ErrorCode::kFileUnreadable, path + " is not a regular file."};
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in || !in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    return Error{ErrorCode::kFileUnreadable, path + " may not be read."};
  if (bytes.empty())
    return Error{ErrorCode::kFormatUnknown,
                 name + " is empty (0 bytes); was the upload or the export cut off?"};
  return bytes;
}

// The following functions repair the bytes of one file, and record in `source` what they found and changed.
// Each returns whether it changed the bytes.

bool RemoveByteOrderMark(std::string& bytes, SourceFile& source) {
  if (!bytes.starts_with("\xef\xbb\xbf")) return false;
  bytes.erase(0, 3);
  source.repairs.push_back("A byte-order mark in front of the file was removed.");
  return true;
}

// Repairs line ends and NUL bytes of a text.
bool RepairCharacters(std::string& bytes, SourceFile& source) {
  bool changed = Contains(bytes, "\r");
  if (UnifyLineEnds(bytes)) source.repairs.push_back("Line ends that consist of CR alone were accepted.");
  const auto nuls = std::count(bytes.begin(), bytes.end(), '\0');
  if (nuls > 0) {
    std::replace(bytes.begin(), bytes.end(), '\0', ' ');
    source.repairs.push_back(std::to_string(nuls) +
                             " NUL bytes were read as spaces; the characters that they replaced are lost.");
    changed = true;
  }
  return changed;
}

Result<bool> PrepareStep(std::string& bytes, SourceFile& source) {
  bool changed = false;
  if (const std::size_t scopes = FlattenScopes(bytes); scopes > 0) {
    source.repairs.push_back(std::to_string(scopes) +
                             " scopes (&SCOPE … ENDSCOPE), which OpenCASCADE does not know, were removed; "
                             "their entities were kept.");
    changed = true;
  }
  if (NormaliseStepTexts(bytes, &source.repairs)) changed = true;
  Result<StepFacts> facts = ScanStep(source.name, bytes);
  if (!facts.ok()) return facts.error();
  source.step = std::move(facts.value());
  if (source.step.open_strings > 0)
    source.repairs.push_back(std::to_string(source.step.open_strings) + " texts have no closing apostrophe.");
  if (source.step.has_tessellation && source.step.faces.empty())
    source.repairs.push_back("Its geometry is tessellated: it is a mesh without exact surfaces.");
  if (source.step.cut_off) {
    // End the data after the last complete entity. Entities that refer to missing ones are lost, and the
    // ledger will name them.
    bytes.resize(source.step.complete_bytes);
    bytes += "\nENDSEC;\nEND-ISO-10303-21;\n";
    source.repairs.push_back("The file is cut off; everything after entity #" +
                             std::to_string(source.step.last_entity) + " is lost.");
    changed = true;
  }
  source.step_repair = RepairStep(bytes);
  if (!source.step_repair.refusal.empty())
    return Error{ErrorCode::kFormatBroken, source.name + " " + source.step_repair.refusal};
  if (source.step_repair.changed) {
    bytes = std::move(source.step_repair.bytes);
    changed = true;
  }
  source.step_repair.bytes.clear();
  source.step.style_contexts = StyleContexts(bytes);
  source.repairs.insert(source.repairs.end(), source.step_repair.warnings.begin(),
                        source.step_repair.warnings.end());
  return changed;
}

Result<bool> PrepareIges(std::string& bytes, SourceFile& source) {
  Result<IgesFacts> facts = ScanIges(source.name, bytes);
  if (!facts.ok()) return facts.error();
  source.iges = std::move(facts.value());
  if (source.iges.cut_off) {
    source.repairs.push_back(
        "The file ends, or is damaged, before its last section; everything after that is lost.");
    return false;
  }
  const IgesRepair repair = RepairIges(bytes);
  if (repair.reals > 0) {
    source.repairs.push_back(std::to_string(repair.reals) +
                             " numbers written as integers were read as the reals that they must be.");
  }
  if (repair.wide_lines > 0) {
    source.repairs.push_back(std::to_string(repair.wide_lines) +
                             " lines with data beyond column 64 were laid out again.");
  }
  return repair.reals > 0 || repair.wide_lines > 0;
}

// Writes the repaired bytes to a file, because OpenCASCADE only reads files. Returns the path.
Result<std::string> WriteRepaired(const std::string& bytes, const SourceFile& source,
                                  const std::string& scratch) {
  const std::string path = scratch + (source.format == CadFormat::kIges   ? "/input.igs"
                                      : source.format == CadFormat::kStep ? "/input.step"
                                                                          : "/input.brep");
  std::ofstream out(path, std::ios::binary);
  if (!out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush())
    return Error{ErrorCode::kWriteFailed,
                 "The repaired copy of " + source.name + " cannot be written into " + scratch + "."};
  return path;
}

}  // namespace

Result<SourceFile> OpenSource(const std::string& path, const std::string& scratch) {
  SourceFile source;
  source.name = std::filesystem::path(path).filename().string();
  Result<std::string> read = ReadSource(path, source.name);
  if (!read.ok()) return read.error();
  std::string bytes = std::move(read.value());
  source.sha256 = Sha256(bytes);

  // Remove text in front of the header before recognising the format.
  bool changed = RemoveByteOrderMark(bytes, source);
  const std::optional<CadFormat> format = Recognise(bytes);
  if (!format) {
    const std::string foreign = Foreign(source.name, bytes);
    return Error{ErrorCode::kFormatUnknown,
                 foreign.empty()
                     ? source.name + " is not a STEP, IGES or BREP file; export the model as STEP."
                     : foreign};
  }
  source.format = *format;
  if (*format != CadFormat::kBrep) {
    if (RepairCharacters(bytes, source)) changed = true;
    const Result<bool> prepared =
        *format == CadFormat::kStep ? PrepareStep(bytes, source) : PrepareIges(bytes, source);
    if (!prepared.ok()) return prepared.error();
    changed = changed || prepared.value();
  }
  source.path = path;
  if (changed) {
    Result<std::string> repaired = WriteRepaired(bytes, source, scratch);
    if (!repaired.ok()) return repaired.error();
    source.path = std::move(repaired.value());
  }
  return source;
}

}  // namespace facetless
