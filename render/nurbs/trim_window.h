// A window of a trim index: what queries within one rectangle of surface parameters need of the index of a face.
//
//     const TrimWindow window = trim.WindowOf(u0, u1, v0, v1, band_scale);
//     for (const Root& root : roots) Use(trim.Query(window, root.u, root.v, root.error_u, root.error_v, scale));
//
//  1. A query through a window has the answer that it has without (except for TrimAnswer::path). A query that does not
//     lie in the window with its errors, or that has a wider band, goes through the whole index.
//  2. Queries near each other open the same few pieces of the loops. A window lists these pieces. The rest of the loops
//     crosses the half-line from a query towards +u a number of times that changes only at the heights of the ends of
//     its runs; the window has the heights within it, and the parity below them.
#pragma once

#include <cstdint>

namespace facetless {

struct TrimWindow {
  static constexpr int kMostPieces = 6, kMostEnds = 8;

  // The rectangle; empty if the window holds no query.
  double u_low = 1, u_high = 0, v_low = 1, v_high = 0;
  double band_scale = 0;   // the widest
  double ends[kMostEnds];  // at each of these heights and above, the rest of the loops has changed its parity
  std::uint32_t pieces[kMostPieces];
  std::uint8_t end_count = 0, piece_count = 0;
  bool odd = false;  // the parity of the rest of the loops below all ends

  // Returns whether a query of this rectangle may use the window. False if a number is not a number.
  bool Holds(double low_u, double high_u, double low_v, double high_v, double scale) const {
    return u_low <= low_u && high_u <= u_high && v_low <= low_v && high_v <= v_high && scale <= band_scale;
  }

  // Adds an end of a run of pieces that cross the half-lines of all queries. Returns false if there is no room.
  bool AddEnd(double v);
  bool AddPiece(std::uint32_t piece);
};

}  // namespace facetless
