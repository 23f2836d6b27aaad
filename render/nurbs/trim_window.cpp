#include "render/nurbs/trim_window.h"

#include "render/nurbs/trim_index.h"

namespace facetless {

bool TrimWindow::AddEnd(double v) {
  if (v <= v_low) {
    odd = !odd;
    return true;
  }
  if (v > v_high) return true;
  // One run begins where another ends, and both cancel.
  for (int i = 0; i < end_count; ++i) {
    if (ends[i] != v) continue;
    ends[i] = ends[--end_count];
    return true;
  }
  if (end_count == kMostEnds) return false;
  ends[end_count++] = v;
  return true;
}

bool TrimWindow::AddPiece(std::uint32_t piece) {
  if (piece_count == kMostPieces) return false;
  pieces[piece_count++] = piece;
  return true;
}

TrimWindow FaceTrim::WindowOf(double u0, double u1, double v0, double v1, double band_scale) const {
  TrimWindow window;
  if (!(u0 <= u1 && v0 <= v1)) return window;
  window.u_low = u0;
  window.u_high = u1;
  window.v_low = v0;
  window.v_high = v1;
  window.band_scale = band_scale;
  if (!nodes_.empty() && !AddToWindow(static_cast<std::uint32_t>(nodes_.size() - 1), &window)) return {};
  return window;
}

bool FaceTrim::AddToWindow(std::uint32_t index, TrimWindow* window) const {
  const Node& node = nodes_[index];
  const double grow_u = window->band_scale * node.band_u, grow_v = window->band_scale * node.band_v;
  const double u_low = window->u_low - grow_u, u_high = window->u_high + grow_u;
  const double v_low = window->v_low - grow_v, v_high = window->v_high + grow_v;
  // In the order in which a query opens them, because the nearest of two coedges at one distance is the first: the
  // pieces, and then what is below the nodes, the last one first.
  std::uint32_t below[kWidth];
  int waiting = 0;
  for (std::uint32_t i = 0; i < node.count; ++i) {
    const std::uint32_t lane = ChildLane(i);
    // Runs above, below and to the left of the window cross no half-line.
    if (node.u_high[lane] < u_low || node.v_low[lane] > v_high || node.v_high[lane] < v_low) continue;
    if (node.u_low[lane] > u_high) {
      if (!window->AddEnd(node.v_begin[lane]) || !window->AddEnd(node.v_end[lane])) return false;
    } else if ((node.child[i] & kPieceBit) == 0) {
      below[waiting++] = node.child[i];
    } else if (!window->AddPiece(node.child[i] & ~kPieceBit)) {
      return false;
    }
  }
  while (waiting > 0)
    if (!AddToWindow(below[--waiting], window)) return false;
  return true;
}

}  // namespace facetless
