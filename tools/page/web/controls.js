// The panel's controls: each shows a part of the state and changes it.

import { by_id, element } from "./dom.js";
import { make_number } from "./numbers.js";
import { is_own_method } from "./link.js";
import { backed } from "./camera.js";
import { adapted, kStops, locked_fov_degrees, nearest_stop, zoomed_focus_m } from "./lens/photographer.js";
import { kShadows, kSizes, lens_keys, parameters, sensors } from "./state.js";

function checked_of(name) {
  return document.querySelector(`input[name="${name}"]:checked`)?.value;
}

function check(name, value) {
  for (const input of document.querySelectorAll(`input[name="${name}"]`)) {
    input.checked = input.value === value;
  }
}

/**
 * `camera()` is the camera in use or null, `move(camera)` sets another; `focus_m()` is the distance
 * in focus and `max_coc()` the largest circle, as the last frame told them where the state leaves
 * them open; `object_m()` the diagram's object; `scene_look()` what the open scene has of a look, or
 * null.
 */
export function make_controls({ store, camera, move, focus_m, max_coc, object_m, scene_look }) {
  let methods = [];
  const side = (patch) => store.change_side(patch);
  const numbers = {};
  const known = new Set();

  /** A control of what the module has a parameter for: `key`. */
  function add(name, key, control) {
    const { least, most, unit } = parameters[key];
    known.add(key);
    numbers[name] = make_number(by_id(`${name}-part`), {
      id: name, tip: key, min: least, max: most, unit: unit === "degrees" ? "°" : unit,
      get: () => store.side()[key], set: (value) => side({ [key]: value }), ...control });
  }

  /** A number of the lens that has no control of its own: the whole range, under the others. */
  function add_plain(key) {
    const { name, least, most } = parameters[key];
    by_id("coc-scale-part").after(element("div", { id: `${name}-part`, class: "number" }));
    const label = name[0].toUpperCase() + name.slice(1).replaceAll("-", " ");
    add(name, key, { label, from: least, to: most });
  }

  /** Once the parameters are known. The sliders' ends are the usual range, for a hand. */
  function start() {
    by_id("sensor").append(...sensors.map(({ name, width_mm, height_mm }) => (
        element("option", { value: name }, `${name}, ${width_mm} × ${height_mm} mm`))));
    add("focal-length", "focal_length_mm",
        { label: "Focal length", key: "L", curve: "log", from: 8, to: 600, set: zoom });
    add("f-number", "f_number",
        { label: "f-number", key: "N", curve: "log", from: 0.7, to: 64, digits: 2,
          spoken: (text) => `f/${text}` });
    add("focus", "focus_m", {
      label: "Focus distance", key: "F", curve: "log", from: 0.1, to: 100, get: focus_m,
      set: (value) => side({ focus: { m: value } }),
      shown_digits: () => (store.side().focus.at ? 4 : 5),
    });
    add("subject-distance", "focus_m", {
      label: "Subject distance", tip: "subject_distance", curve: "log", from: 0.3, to: 30,
      get: focus_m, set: go_to });
    add("backdrop", "backdrop_m", {
      label: "Backdrop distance", curve: "log", from: 2, to: 100, shown_digits: () => 3,
      get: () => store.get().look.backdrop_m ?? scene_look()?.backdrop_m,
      set: (value) => look({ backdrop_m: value }) });
    add("blades", "aperture_blades", {
      label: "Blades", values: [0, 3, 4, 5, 6, 7, 8, 9, 11, 14, 18],
      allows: (value) => Number.isInteger(value) && value !== 1 && value !== 2, wanted: "0 or 3 to 64",
      spoken: (text) => (text === "0" ? "round" : `${text} blades`) });
    add("turn", "aperture_turn_degrees", { label: "Turn of the blades", from: -180, to: 180, decimals: 0 });
    add("anamorphic", "anamorphic", { label: "Height over width", unit: "×", curve: "log",
                                      from: 0.25, to: 4 });
    add("gain", "highlight_gain", { label: "Highlights, gain", unit: "×", curve: "log", from: 1, to: 64 });
    add("threshold", "highlight_threshold", { label: "Highlights, from", from: 0, to: 1,
                                              decimals: 2 });
    add("max-coc", "max_coc_px", { label: "Filter size, radius", key: "X", curve: "root", from: 0, to: 128,
                                   digits: 2, decimals: 1, get: max_coc, shown_digits: () => 4 });
    add("coc-scale", "coc_scale", { label: "Scale of the circles", unit: "×", key: "K",
                                    curve: "root", from: 0, to: 10, digits: 2, decimals: 2,
                                    spoken: (text) => `${text} times` });
    for (const key of lens_keys().filter((one) => !known.has(one))) add_plain(key);
    add("samples", "samples", {
      label: "Points of the lens", values: [1, 4, 16, 64, 256, 1024, 4096],
      set: (value) => side({ samples: Math.round(value) }), spoken: (text) => `${text} points`,
    });
    add("fov", "fov_y_degrees", {
      label: "Field of view", from: 5, to: 120, get: () => camera()?.fov_y_degrees,
      shown_digits: () => 4,
      set: (value) => {
        const now = camera();
        if (now) move({ ...now, fov_y_degrees: value });
      },
    });
    add("object", "focus_m", { label: "Object", tip: "object", curve: "log", from: 0.1, to: 1000,
                               get: object_m, set: (value) => store.change({ object_m: value }) });
  }

  by_id("stop").append(...kStops.map((stop) => element("option", { value: stop }, `f/${stop}`)));

  const on_change = (id, take) => by_id(id).addEventListener("change", (event) => take(event.target));
  on_change("dof", ({ checked }) => side({ dof: checked }));
  on_change("method", ({ value }) => side({ method: value }));
  on_change("compare", ({ checked }) => compare(checked));
  on_change("photo", ({ checked }) => photo({ on: checked }));
  on_change("sensor", ({ value }) => photo({ sensor: value }));
  on_change("keep", ({ value }) => photo({ keep: value }));
  on_change("lock", ({ checked }) => photo({ lock: checked }));
  on_change("subject", ({ checked }) => photo({ subject: checked }));
  on_change("stop", ({ value }) => side({ f_number: Number(value) }));
  on_change("size", () => store.change({ size: checked_of("size").split("x").map(Number) }));
  on_change("show", () => store.change({ show: checked_of("show") }));
  on_change("side-part", () => store.change({ editing: Number(checked_of("editing")) }));
  by_id("focus-centre").addEventListener("click", () => side({ focus: { at: [0.5, 0.5] } }));

  const look = (patch) => store.change({ look: { ...store.get().look, ...patch } });
  on_change("shadows", ({ value }) => look({ shadows: value || null }));
  on_change("textures", ({ checked }) => look({ textures: checked }));
  on_change("wireframe", ({ checked }) => store.change({ show: checked ? "wireframe" : "image" }));
  on_change("impostors", ({ checked }) => look({ impostors: checked ? null : "off" }));
  on_change("effect", ({ value }) => look({ effect: value || null }));
  by_id("light-home").addEventListener("click", () => look({ light: null }));

  function update_look(state) {
    const has = scene_look();
    const now = state.look;
    by_id("look-part").hidden = !has;
    by_id("shadows").value = now.shadows ?? "";
    by_id("shadows").disabled = by_id("light-drag").disabled = !has?.light;
    by_id("light-home").disabled = !now.light;
    by_id("textures").checked = now.textures;
    by_id("textures").disabled = !has?.textures;
    by_id("wireframe").checked = state.show === "wireframe";
    by_id("impostors").checked = now.impostors !== "off";
    by_id("impostors-part").hidden = !has?.impostors;
    by_id("distances-part").hidden = !camera();
    by_id("backdrop-part").hidden = !has?.backdrop_m;
    const effect = by_id("effect");
    if (now.effect && ![...effect.options].some(({ value }) => value === now.effect)) {
      effect.append(element("option", {}, now.effect));
    }
    effect.value = now.effect ?? "";
  }

  const within = (key, value) => Math.min(parameters[key].most, Math.max(parameters[key].least, value));

  function photo(patch) {
    const state = store.get();
    const now = camera();
    const next = { ...state.photo, ...patch };
    const { focal_length_mm, fov_y_degrees } =
        now ? adapted(state, next, { ...store.side(), focus_m: focus_m() }, now.fov_y_degrees) : {};
    store.change({ photo: next });
    if (patch.on) side({ f_number: nearest_stop(store.side().f_number) });
    if (focal_length_mm) side({ focal_length_mm: within("focal_length_mm", focal_length_mm) });
    if (fov_y_degrees) move({ ...now, fov_y_degrees: within("fov_y_degrees", fov_y_degrees) });
  }

  /** The camera comes nearer to what is in focus, or goes back from it, and the focus stays on it. */
  function go_to(metres) {
    const now = camera();
    if (!now) return;
    const way = metres - focus_m();
    const { sides, editing } = store.get();
    const kept = ({ focus }) => (focus.at ? focus : { m: within("focus_m", focus.m + way) });
    store.change({ sides: sides.map((one, index) => (
        { ...one, focus: index === editing ? { m: metres } : kept(one) })) });
    move(backed(now, way));
  }

  /** Another focal length; the camera moves if the subject's size is kept. */
  function zoom(focal_length_mm) {
    const { on, lock, subject } = store.get().photo;
    const now = camera();
    if (!(on && lock && subject && now)) return side({ focal_length_mm });
    const lens = { ...store.side(), focus_m: focus_m() };
    const metres = within("focus_m", zoomed_focus_m(lens, focal_length_mm));
    side({ focal_length_mm, focus: { m: metres } });
    return move(backed(now, metres - lens.focus_m));
  }

  /** B begins as a copy of A, so that one change shows alone. */
  function compare(on) {
    const { sides } = store.get();
    const next = on ? [sides[0], sides[1] ?? { ...sides[0] }] : [sides[0]];
    store.change({ sides: next, editing: on ? 1 : 0 });
  }

  const is_centre = ({ at }) => Boolean(at) && at[0] === 0.5 && at[1] === 0.5;

  function focus_words(focus) {
    if (!focus.at) return "or click in the picture";
    return `follows the ${is_centre(focus) ? "centre" : "clicked place"}`;
  }

  function update() {
    const state = store.get();
    const now = store.side();
    by_id("dof").checked = now.dof;
    const own = by_id("method-own");
    if (own) {
      own.hidden = !state.shader;
      own.value = is_own_method(now.method) ? now.method : state.shader?.method ?? "";
    }
    by_id("method").value = now.method;
    const method = methods.find(({ name }) => name === now.method);
    by_id("method-summary").textContent =
        method?.summary ?? (is_own_method(now.method) ? "the shader of the tab Shader" : "");
    const of_scene = by_id("method").querySelector("optgroup:last-child");
    if (of_scene) of_scene.disabled = Boolean(state.picture);
    by_id("samples-part").hidden = !method?.samples;
    by_id("aperture-part").hidden = Boolean(state.failure);
    by_id("blades-part").hidden = !method?.blades;
    by_id("turn-part").hidden = !method?.stretch || now.aperture_blades === 0;
    by_id("anamorphic-part").hidden = !method?.stretch;
    by_id("aperture-why").hidden = Boolean(method?.blades);
    by_id("compare").checked = state.sides.length > 1;
    by_id("side-part").hidden = state.sides.length < 2;
    check("editing", String(state.editing));
    by_id("photo").checked = state.photo.on;
    by_id("photo-part").hidden = !state.photo.on;
    by_id("f-number-part").hidden = state.photo.on;
    by_id("sensor").value = state.photo.sensor;
    by_id("keep").value = state.photo.keep;
    by_id("lock").checked = state.photo.lock;
    by_id("subject").checked = state.photo.subject;
    by_id("subject").disabled = !state.photo.lock;
    by_id("stop").value = String(nearest_stop(now.f_number));
    check("size", state.size.join("x"));
    check("show", state.show);
    update_look(state);
    const locked = locked_fov_degrees(state, { ...now, focus_m: focus_m() }) !== null;
    for (const input of by_id("fov-part").querySelectorAll("input")) {
      input.disabled = locked || !camera();
    }
    by_id("focus-centre").setAttribute("aria-pressed", String(is_centre(now.focus)));
    by_id("focus-how").textContent = focus_words(now.focus);
    for (const name of Object.keys(numbers)) numbers[name].update();
  }

  return {
    start,
    update,
    compare,
    nudge(name, steps) {
      if (name !== "f-number" || !store.get().photo.on) {
        numbers[name]?.nudge(steps);
        return;
      }
      const at = kStops.indexOf(nearest_stop(store.side().f_number));
      side({ f_number: kStops[Math.min(kStops.length - 1, Math.max(0, at + steps))] });
    },
    change_look: look,
    next_shadows() {
      const { shadows } = store.get().look;
      const at = kShadows.indexOf(shadows ?? scene_look()?.shadows ?? "none");
      if (scene_look()?.light) look({ shadows: kShadows[(at + 1) % kShadows.length] });
    },
    set_effects(names) {
      by_id("effect").append(...names.map((name) => element("option", {}, name)));
    },
    next_size() {
      if (store.get().picture) return;  // which has a size of its own
      const at = kSizes.findIndex((size) => size.join() === store.get().size.join());
      store.change({ size: kSizes[(at + 1) % kSizes.length] });
    },
    set_methods(list) {
      methods = list;
      const group = (label, kind) => {
        const options = list.filter((method) => method.kind === kind)
            .map(({ name, summary }) => element("option", { value: name, title: summary }, name));
        return element("optgroup", { label }, ...options);
      };
      const own = element("option", { id: "method-own", hidden: "" }, "your shader");
      by_id("method").replaceChildren(own, group("Filters of the picture", "filter"),
                                      group("From the scene", "views"));
      update();
    },
  };
}
