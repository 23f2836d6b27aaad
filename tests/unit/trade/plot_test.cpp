// The plot as files, and the places of its labels.
#include "render/trade/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "render/trade/plot_labels.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

LogPlot TwoSeries() {
  LogPlot plot;
  plot.title = "part.step <time> & error";
  plot.x_floor = 1e-10;
  plot.pixels_per_mm = 4;
  plot.x_limit = 0.1;
  plot.x_limit_label = "limit";
  plot.series = {{"direct"}, {"mesh"}};
  plot.points = {{0, 100, 0, "exact", true}, {1, 10, 1, "coarse", true}, {0.01, 200, 1, "fine", false}};
  plot.front = {1, 0};
  plot.chains = {{1, 2}};
  plot.notes = {"a note"};
  return plot;
}

TEST(Plot, IsAnSvgThatFetchesNothing) {
  const Result<std::string> svg = PlotSvg(TwoSeries());
  ASSERT_TRUE(svg.ok()) << svg.error().message;
  EXPECT_THAT(svg.value(), StartsWith("<?xml"));
  EXPECT_THAT(svg.value(), HasSubstr("</svg>"));
  EXPECT_THAT(svg.value(), Not(HasSubstr("href=\"http")));
  EXPECT_THAT(svg.value(), Not(HasSubstr("part.step <time>")));
}

TEST(Plot, IsAPngOfTwiceItsSize) {
  const Result<std::string> png = PlotPng(TwoSeries());
  ASSERT_TRUE(png.ok()) << png.error().message;
  ASSERT_GT(png.value().size(), 24u);
  EXPECT_EQ(png.value().substr(1, 3), "PNG");
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(png.value()[at + i]);
    return value;
  };
  EXPECT_EQ(number(16), 1920u);
  EXPECT_EQ(number(20), 1200u);
}

TEST(Plot, HasTheSameBytesAgain) {
  EXPECT_EQ(PlotSvg(TwoSeries()).value(), PlotSvg(TwoSeries()).value());
  EXPECT_EQ(PlotPng(TwoSeries()).value(), PlotPng(TwoSeries()).value());
}

TEST(Plot, ShowsAnErrorOfZeroAsItShowsOneAtTheFloor) {
  LogPlot plot = TwoSeries();
  const std::string zero = PlotPng(plot).value();
  plot.points[0].x = plot.x_floor;
  EXPECT_EQ(PlotPng(plot).value(), zero);
  plot.points[0].x = 10 * plot.x_floor;
  EXPECT_NE(PlotPng(plot).value(), zero);
}

TEST(Plot, IsDrawnOfOnePointAndOfNone) {
  LogPlot plot = TwoSeries();
  plot.points = {{0, 100, 0, "exact", true}};
  plot.front = {0};
  plot.chains.clear();
  plot.x_limit.reset();
  EXPECT_TRUE(PlotSvg(plot).ok());
  plot.points.clear();
  plot.front.clear();
  EXPECT_TRUE(PlotSvg(plot).ok());
}

TEST(Plot, RefusesWhatHasNoPlace) {
  for (const double y : {0.0, -1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    LogPlot plot = TwoSeries();
    plot.points[1].y = y;
    const Result<std::string> svg = PlotSvg(plot);
    ASSERT_FALSE(svg.ok()) << y;
    EXPECT_EQ(svg.error().code, ErrorCode::kBadUsage);
    EXPECT_THAT(svg.error().message, HasSubstr("coarse"));
  }
}

const PlotBox kBounds = {0, 0, 800, 500};

TEST(PlotLabels, StandToTheRightOfALonelyPoint) {
  const std::vector<LabelPlace> places = PlaceLabels({{400, 250, 60, 15}}, {}, kBounds);
  EXPECT_GT(places[0].box.x, 400);
  EXPECT_DOUBLE_EQ(places[0].box.y + 7.5, 250);
  EXPECT_FALSE(places[0].leader);
}

TEST(PlotLabels, StayInside) {
  const std::vector<LabelPlace> places = PlaceLabels({{795, 250, 60, 15}, {5, 4, 60, 15}}, {}, kBounds);
  for (const LabelPlace& place : places)
    EXPECT_DOUBLE_EQ(OverlapArea(place.box, kBounds), place.box.width * place.box.height);
}

RC_GTEST_PROP(PlotLabelsProperty, AvoidEachOtherWhereThereIsRoom, ()) {
  // Place up to ten points in the middle of the paper.
  const auto points = *rc::gen::container<std::vector<std::pair<int, int>>>(
      rc::gen::pair(rc::gen::inRange(200, 600), rc::gen::inRange(150, 350)));
  std::vector<LabelRequest> requests;
  for (std::size_t i = 0; i < std::min<std::size_t>(points.size(), 10); ++i)
    requests.push_back({static_cast<double>(points[i].first), static_cast<double>(points[i].second), 60, 15});
  const std::vector<LabelPlace> places = PlaceLabels(requests, {}, kBounds);
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      RC_ASSERT(OverlapArea(places[a].box, places[b].box) <= 0.05 * 60 * 15);
}

}  // namespace
}  // namespace facetless
