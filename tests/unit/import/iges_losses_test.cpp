// Entities that an IGES file declares and OpenCASCADE does not convert: bodies of other kinds, scaled
// subfigures, entities that refer to themselves.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

struct Entity {
  int type = 0, form = 0;
  std::string parameters;
  int matrix = 0, view = 0;  // directory numbers
  std::string status = "00000000";
};

std::string Line(const std::string& text, char section, std::size_t number) {
  std::string line = text;
  line.resize(72, ' ');
  char tail[16];
  std::snprintf(tail, sizeof(tail), "%c%7zu\n", section, number);
  return line + tail;
}

std::string IgesFile(const std::vector<Entity>& entities) {
  const std::string global =
      "1H,,1H;,4Htest,8Htest.igs,4Hnone,3H1.0,32,38,6,308,15,4Htest,1.0,2,2HMM,1,0.01,15H20260101.000000,1.E-"
      "6,100.0,"
      "4Hnone,4Hnone,11,0,15H20260101.000000;";
  std::string file = Line("synthetic", 'S', 1), directory, parameters;
  std::size_t globals = 0, lines = 0;
  for (std::size_t at = 0; at < global.size(); at += 72) file += Line(global.substr(at, 72), 'G', ++globals);
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const Entity& entity = entities[i];
    const std::size_t number = 2 * i + 1, first = lines + 1;
    std::vector<std::string> chunks{""};
    std::string rest = std::to_string(entity.type) + "," + entity.parameters + ";";
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(','), rest.size() - 1) + 1;
      if (chunks.back().size() + end > 64) chunks.emplace_back();
      chunks.back() += rest.substr(0, end);
      rest.erase(0, end);
    }
    for (std::string chunk : chunks) {
      chunk.resize(64, ' ');
      char of[16];
      std::snprintf(of, sizeof(of), "%8zu", number);
      parameters += Line(chunk + of, 'P', ++lines);
    }
    char record[128];
    std::snprintf(record, sizeof(record), "%8d%8zu%8d%8d%8d%8d%8d%8d%8s", entity.type, first, 0, 1, 0,
                  entity.view, entity.matrix, 0, entity.status.c_str());
    directory += Line(record, 'D', number);
    std::snprintf(record, sizeof(record), "%8d%8d%8d%8zu%8d%8s%8s%8s%8d", entity.type, 0, 0, chunks.size(),
                  entity.form, "", "", "", 0);
    directory += Line(record, 'D', number + 1);
  }
  char counts[64];
  std::snprintf(counts, sizeof(counts), "S%7dG%7zuD%7zuP%7zu", 1, globals, 2 * entities.size(), lines);
  return file + directory + parameters + Line(counts, 'T', 1);
}

const char kSheet[] =
    "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,30.,0.,0.,0.,20.,0.,30.,20.,10.,0.,1.,0.,"
    "1.";

Result<Conversion> Converted(const std::vector<Entity>& entities) {
  const TemporaryFolder folder;
  std::ofstream(folder.File("part.igs"), std::ios::binary) << IgesFile(entities);
  return ConvertFile(folder.File("part.igs"));
}

TEST(IgesLosses, BodiesOfOtherKindsAreNamed) {
  const auto conversion = Converted(
      {{128, 0, kSheet}, {150, 0, "10.,10.,10.,0.,0.,0.,1.,0.,0.,0.,0.,1."}, {158, 0, "5.,0.,0.,0."}});
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  const ImportInfo& info = conversion.value().model.info;
  EXPECT_EQ(info.faces_declared, 3u);
  EXPECT_EQ(info.faces_imported, 1u);
  ASSERT_EQ(info.faces_lost.size(), 2u);
  EXPECT_EQ(info.faces_lost[0].entity, "D3");
  EXPECT_NE(info.faces_lost[0].reason.find("type 150"), std::string::npos);
}

TEST(IgesLosses, ScaledSubfiguresAreNamed) {
  const auto with_scale = [](const std::string& scale) {
    return Converted({{128, 0, kSheet},
                      {128, 0, kSheet, 0, 0, "00010000"},
                      {308, 0, "0,3Hsub,1,3", 0, 0, "00000201"},
                      {408, 0, "5,50.,0.,0.," + scale}});
  };
  const auto plain = with_scale("1."), scaled = with_scale("2.");
  ASSERT_TRUE(plain.ok() && scaled.ok());
  EXPECT_TRUE(plain.value().model.info.faces_lost.empty());
  EXPECT_EQ(plain.value().model.PlacedFaceCount(), 2u);
  ASSERT_EQ(scaled.value().model.info.faces_lost.size(), 1u);
  EXPECT_EQ(scaled.value().model.info.faces_lost[0].entity, "D7");
}

TEST(IgesLosses, MirroringMatricesAreApplied) {
  const auto conversion =
      Converted({{128, 0, kSheet, 3}, {124, 1, "-1.,0.,0.,50.,0.,1.,0.,0.,0.,0.,1.,0.", 0, 0, "00010000"}});
  ASSERT_TRUE(conversion.ok()) << conversion.error().message;
  EXPECT_NEAR(conversion.value().model.bounds.low.x, 20, 1e-9);
  EXPECT_NEAR(conversion.value().model.bounds.high.x, 50, 1e-9);
  EXPECT_NEAR(conversion.value().model.bounds.high.y, 20, 1e-9);
}

TEST(IgesLosses, AnEntityThatPointsToItselfIsNamed) {
  for (const Entity& entity :
       {Entity{128, 0, kSheet, 1}, Entity{128, 0, kSheet, 0, 1}, Entity{102, 0, "2,1,1"},
        Entity{142, 0, "1,1,0,0,1"}, Entity{144, 0, "1,0,0,0"}, Entity{308, 0, "0,3Hsub,1,1"},
        Entity{408, 0, "1,0.,0.,0.,1."}}) {
    const auto conversion = Converted({entity, {128, 0, kSheet}});
    ASSERT_FALSE(conversion.ok()) << entity.type;
    EXPECT_EQ(conversion.error().code, ErrorCode::kFormatBroken) << entity.type;
    EXPECT_NE(conversion.error().message.find("D1 contains itself"), std::string::npos)
        << conversion.error().message;
  }
}

}  // namespace
}  // namespace facetless
