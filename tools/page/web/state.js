// All that a link carries: plain data, and the request of a frame that follows from it.

export const kFirstScene = "portrait";
export const kThesisScenes = ["figures", "cube-room", "sphere-world"];
export const kSizes = [[512, 512], [1024, 512], [1024, 1024]];
export const kShows = ["image", "coc", "depth", "wireframe", "truth", "error"];
export const kMaps = ["coc", "depth", "wireframe"];
export const kShadows = ["none", "projected", "volumes", "map"];

/** Of what can be set, by the keys of requests: text, unit, least, most, preset. The module tells. */
export const parameters = {};
/** name, width_mm, height_mm. */
export const sensors = [];
export function set_parameters(of_module, known_sensors) {
  Object.assign(parameters, of_module);
  sensors.splice(0, sensors.length, ...known_sensors);
}

/** The keys of the lens's numbers. */
export const lens_keys = () => Object.keys(parameters).filter((key) => parameters[key].of_lens);

/** A lens's numbers out of something that has more; the focus is `side.focus`. */
function lens_of(from) {
  const keys = lens_keys().filter((key) => key !== "focus_m");
  return Object.fromEntries(keys.map((key) => [key, from(key)]));
}

const preset = (key) => parameters[key]?.preset ?? null;

/** What a side has besides and seldom sets: requests and links leave out what is as preset. */
export const kSeldomSet = ["aperture_blades", "aperture_turn_degrees", "anamorphic", "highlight_gain",
                           "highlight_threshold"];
export const seldom_set = (side) => kSeldomSet.filter((key) => side[key] !== preset(key));

/** One of the two settings that can be compared: a method and its lens. */
export function first_side() {
  return {
    dof: true,
    method: "disc-layers",  // as `render` without --method
    /** Metres, or a place in the picture, 0..1 from the top left. */
    focus: { m: preset("focus_m") },
    ...lens_of(preset),
    max_coc_px: null,  // null: the scene's, or what the method does best with
    coc_scale: preset("coc_scale"),
    samples: preset("samples"),
    ...Object.fromEntries(kSeldomSet.map((key) => [key, preset(key)])),
  };
}

/** What the scene is drawn with; null: as it says. `light` is the first light's place or direction. */
export const first_look = () => (
    { light: null, shadows: null, textures: true, impostors: null, effect: null, backdrop_m: null });

export function first_state() {
  return {
    /** A name, a file under /own/, or null while a failure case is open. */
    scene: kFirstScene,
    failure: null,  // {name, value}
    /** Of a picture, whose file is `scene`: {depth, size, encoding, numbers,
     * choices}; see panels/picture.js. */
    picture: null,
    /** The visitor's shader that ran last: {text, passes, method}. */
    shader: null,
    size: [512, 512],
    time: 0,
    camera: null,  // null: the scene's own, {position_m, target_m, fov_y_degrees}
    look: first_look(),
    show: "image",
    sides: [first_side()],
    editing: 0,
    divider: 0.5,
    /** `keep`: what another sensor leaves as it is, "framing" or "focal-length"; `lock`: the focal length
     * sets the field of view; `subject`: zooming then moves the camera. */
    photo: { on: false, sensor: "full-frame", keep: "framing", lock: false, subject: false },
    object_m: null,  // the object of the lens diagram; null: 1.5 times the focus distance
  };
}

/** The state with the camera and lens that a scene or a picture asks for. */
export function with_scene(state, opened) {
  const { focus_m, coc_scale } = opened.lens;
  const side = {
    ...first_side(), ...lens_of((key) => opened.lens[key]), coc_scale,
    focus: opened.autofocus ? { at: [0.5, 0.5] } : { m: focus_m },
  };
  const sides = state.sides.map((old) => ({ ...side, dof: old.dof, method: old.method,
                                            samples: old.samples }));
  return { ...state, camera: null, look: first_look(), time: 0, object_m: null, sides };
}

/** The state of a picture of that size. It is shown by filters alone, and has no truth. */
export function with_picture(state, { width, height }, methods) {
  const filters = methods.filter(({ kind }) => kind === "filter").map(({ name }) => name);
  return {
    ...state, camera: null, look: first_look(), picture: { ...state.picture, size: [width, height] },
    show: ["truth", "error", "wireframe"].includes(state.show) ? "image" : state.show,
    sides: state.sides.map((side) => (
        filters.includes(side.method) ? side : { ...side, method: "two-pass" })),
  };
}

/**
 * The `frame` request of one side. `preview` divides the size, 1 is the full picture. Where the
 * error of a picture without depth of field is asked for, it is one by the method pinhole: that
 * keeps its lens.
 */
export function frame_request(state, side, preview, hash = true) {
  const measured = state.show === "truth" || state.show === "error";
  const request = {
    do: "frame",
    size: state.size,
    time: state.time,
    dof: side.dof || measured,
    method: side.dof || !measured ? side.method : "pinhole",
    show: kMaps.includes(state.show) ? state.show : "image",
    focus: side.focus,
    ...lens_of((key) => side[key]),
    max_coc_px: side.max_coc_px,
    coc_scale: side.coc_scale,
    samples: side.samples,
    preview,
    numbers: ["coc", "depth"].includes(state.show),
    hash: hash && preview === 1,
  };
  if (state.camera) request.camera = state.camera;
  if (state.failure) return request;  // whose answer is of a round aperture
  for (const key of seldom_set(side)) request[key] = side[key];
  if (state.picture) return request;
  const { light, shadows, textures, impostors, effect, backdrop_m } = state.look;
  Object.assign(request, light && { light }, shadows && { shadows }, !textures && { textures },
                impostors && { impostors }, effect && { effect }, backdrop_m && { backdrop_m });
  return request;
}

/** A holder of the state that tells its listeners of every change, once a turn. */
export function make_store(first) {
  let state = first;
  let told = first;
  let due = false;
  const listeners = [];
  const tell = () => {
    due = false;
    const before = told;
    told = state;
    for (const listener of listeners) listener(state, before);
  };
  const set = (next) => {
    state = next;
    if (due) return;
    due = true;
    queueMicrotask(tell);
  };
  return {
    get: () => state,
    set,
    change: (patch) => set({ ...state, ...patch }),
    side: () => state.sides[state.editing] ?? state.sides[0],
    change_side: (patch) => {
      const sides = state.sides.slice();
      sides[state.editing] = { ...sides[state.editing], ...patch };
      set({ ...state, sides });
    },
    /** Called with (state, the state told before). */
    listen: (listener) => listeners.push(listener),
  };
}
