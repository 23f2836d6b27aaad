// What a file says about the look and the names of its parts: hidden items, colours of occurrences,
// transparency, names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "tests/support/files.h"
#include "tests/unit/import/shapes.h"

namespace facetless {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Styles : public ::testing::Test {
 protected:
  // Reads the file, or skips the test if the file is absent.
  void Read(const std::string& file) {
    const std::string path = CadFile("cases/" + file);
    if (path.empty())
      GTEST_SKIP() << "FACETLESS_CAD names no folder with " << file << ", which is not tested";
    Result<Conversion> conversion = ConvertFile(path);
    ASSERT_TRUE(conversion.ok()) << conversion.error().message;
    model_ = std::move(conversion.value().model);
  }
  std::size_t Hidden() const {
    std::size_t count = 0;
    for (const Instance& instance : model_.instances) count += instance.hidden;
    return count;
  }

  Model model_;
};

TEST_F(Styles, AnInvisibleBodyIsAHiddenPlacement) {
  Read("invisible.step");
  if (IsSkipped()) return;
  ASSERT_EQ(model_.instances.size(), 2u);
  EXPECT_EQ(Hidden(), 1u);
  EXPECT_EQ(model_.parts[0].faces.count, model_.parts[1].faces.count);
  EXPECT_THAT(model_.info.faces_lost, IsEmpty());
  EXPECT_EQ(model_.info.faces_declared, model_.info.faces_imported);
}

TEST_F(Styles, ABlankedEntityOfIgesIsHidden) {
  Read("i_blank.igs");
  if (IsSkipped()) return;
  EXPECT_EQ(Hidden(), model_.instances.size());
}

TEST_F(Styles, TransparencyIsRead) {
  Read("transparent.step");
  if (IsSkipped()) return;
  std::set<float> opacities;
  for (std::uint32_t id = 0; id < model_.PlacedFaceCount(); ++id)
    opacities.insert(std::round(100 * model_.PlacedFaceColor(id).a) / 100);
  EXPECT_THAT(opacities, ::testing::ElementsAre(0.3f, 1.0f));
}

TEST_F(Styles, AnOccurrencesColourStaysWithIt) {
  Read("occurrence_colour.step");
  if (IsSkipped()) return;
  ASSERT_EQ(model_.instances.size(), 2u);
  for (std::uint32_t i = 0; i < 2; ++i) {
    const Instance& instance = model_.instances[i];
    const bool right = instance.name.ends_with("right");
    const Color color = model_.PlacedFaceColor(instance.first_placed_face);
    EXPECT_EQ(color.r, right ? 0 : 1) << instance.name;
    EXPECT_EQ(color.b, right ? 1 : 0) << instance.name;
  }
}

struct Naming {
  const char* file;
  const char* name;  // name of the part
  const char* said;  // part of a warning; "": there is none
};

class Names : public Styles, public ::testing::WithParamInterface<Naming> {};

TEST_P(Names, ComeOutAsTheyWereMeant) {
  Read(GetParam().file);
  if (IsSkipped()) return;
  std::set<std::string> names;
  for (const Part& part : model_.parts) names.insert(part.name);
  for (const Instance& instance : model_.instances) {
    for (std::size_t at = 0; at != std::string::npos;) {
      const std::size_t end = instance.name.find('/', at);
      names.insert(instance.name.substr(at, end == std::string::npos ? end : end - at));
      at = end == std::string::npos ? end : end + 1;
    }
  }
  EXPECT_THAT(names, Contains(GetParam().name));
  if (*GetParam().said != '\0') {
    EXPECT_THAT(model_.info.warnings, Contains(HasSubstr(GetParam().said)));
  } else {
    EXPECT_THAT(model_.info.warnings, IsEmpty());
  }
}

INSTANTIATE_TEST_SUITE_P(OfFiles, Names,
                         ::testing::Values(Naming{"name_x_e9.step", "Petit étui", ""},
                                           Naming{"name_x2.step", "供给系统", ""},
                                           Naming{"name_x4.step", "😀", ""},
                                           Naming{"name_s.step", "Gehäuse", ""},
                                           Naming{"name_utf8_cjk.step", "姿态控制舱段", ""},
                                           Naming{"name_latin1.step", "Gehäuse", "ISO 8859-1"},
                                           Naming{"name_shiftjis.step", "表示ソフト", "Shift-JIS"},
                                           Naming{"lat_gehaeuse.stp", "Gehäuse", "ISO 8859-1"},
                                           Naming{"name_rawctl.stp",
                                                  "a\xef\xbf\xbd"
                                                  "b\xef\xbf\xbd"
                                                  "c\xef\xbf\xbd"
                                                  "d",
                                                  "control characters"}),
                         [](const ::testing::TestParamInfo<Naming>& info) {
                           std::string name = info.param.file;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace facetless
