// The numbers of a view, with the terms of docs/comparison.md.
import { element, given, number, share, table } from "./dom.js";

// `noun` names the representation with which the surfaces are compared.
export const differenceTables = (d, noun = "mesh") => {
  const spread = (title, s) => [title, number(s.mean), number(s.p50), number(s.p95), number(s.p99), number(s.max)];
  const silhouette = d.silhouette.max_distance_px === null ? "∞" : number(d.silhouette.max_distance_px);
  return [
    element("section", {}, element("h3", {}, "Difference"),
      table("Difference in millimetres and degrees", ["", "mean", "p50", "p95", "p99", "max"], [spread("deviation, mm", d.deviation_mm), spread("depth, mm", d.depth_mm), spread("normal, °", d.normal_deg)]),
      element("p", { class: "facts" }, `${d.noise_mm > 0 ? `Positions of the ${noun} are accurate to ${number(d.noise_mm)} mm. ` : ""}${share(d.border.share)} of the pixels that both hit are border pixels, which are not counted in deviation and normal.`)),
    element("section", {}, element("h3", {}, "Picture"),
      table("Difference of the pictures", null, [["FLIP, mean", number(d.color.flip_mean)], ["FLIP, p95", number(d.color.flip_p95)], ["SSIM", d.color.ssim.toFixed(4)],
        ["PSNR", d.color.psnr === null ? "equal" : `${number(d.color.psnr)} dB`], ["Pixels that differ", share(d.color.share_over_threshold)],
        ["Silhouette", `${number(d.silhouette.pixels)} px`], ["… farthest", `${silhouette} px`], d.other_face ? ["Other face shown", `${number(d.other_face.pixels)} px`] : null].filter(Boolean))),
  ];
};

// A table of the results of the secondary rays: of `light` of the exact surfaces, and of that of the difference.
export const lightTable = (light, difference) =>
  !light ? null : element("section", {}, element("h3", {}, "Light"),
    table("Light", null, [["Rays", number(light.rays)], ["Samples with light", number(light.samples)], ["… proven", share(light.samples > 0 ? light.certified / light.samples : 1)],
      ...(difference?.shadow ? [["Lit on one, dark on the other", share(difference.shadow.share)], given(difference.shadow.false_self_shadow) && ["Shades itself falsely", `${number(difference.shadow.false_self_shadow)} px`]] : []),
      ...(difference?.occlusion ? [["Occlusion, mean |difference|", share(difference.occlusion.mean_abs)]] : [])].filter(Boolean)));

export const certaintyTable = (direct) =>
  element("section", {}, element("h3", {}, "Certificates of the direct image"),
    table("Certificates", null, [["certified", number(direct.certified)], ["converged, not proven", number(direct.converged)], ["unresolved", number(direct.unresolved)], ["Rays", number(direct.rays)], ["Hits", number(direct.hits)],
      given(direct.odd_rays) && ["Odd rays", number(direct.odd_rays)], given(direct.reverse_mismatches) && ["Opposite view differs", number(direct.reverse_mismatches)],
      direct.method && ["Method", direct.method.name], direct.method && ["Starts", direct.method.structure ? `pieces, ${direct.method.structure}` : direct.method.starts], direct.method && ["Roots", number(direct.method.roots)],
      given(direct.method?.rays_without_start) && ["Rays without a start", number(direct.method.rays_without_start)],
      direct.unseen_faces?.length > 0 && ["Faces that no ray hits", number(direct.unseen_face_count ?? direct.unseen_faces.length)]].filter(Boolean)));

export const cameraText = (camera) =>
  `${camera.projection}, ${camera.width} × ${camera.height_px} pixels, ` + (camera.fov_y_deg !== undefined ? `${number(camera.fov_y_deg)}° high` : `${number(camera.height)} mm high`);
