// All that a link carries: plain data, and the request of a frame that follows from it.

export const kSizes = [[512, 512], [1024, 512], [1024, 1024]];
export const kShows = ["picture", "coc", "depth", "truth", "error"];

/** One of the two settings that can be compared: a method and its lens. */
export function first_side() {
  return {
    dof: true,
    method: "two-pass",
    /** Metres, or a place in the picture, 0..1 from the top left. */
    focus: { m: 1 },
    focal_length_mm: 50,
    f_number: 2,
    max_coc_px: null,  // null: the scene's, or what the method does best with
    coc_scale: 1,
    samples: 64,
  };
}

export function first_state() {
  return {
    /** A name, a file under /own/, or null while a failure case is open. */
    scene: "figures",
    failure: null,  // {name, value}
    /** Of a picture, whose file is `scene`: {depth, size, encoding, numbers}; see panels/picture.js. */
    picture: null,
    size: [512, 512],
    time: 0,
    camera: null,  // null: the scene's own, {position_m, target_m, fov_y_degrees}
    show: "picture",
    sides: [first_side()],
    editing: 0,
    divider: 0.5,
    photo: { on: false, sensor: "full-frame", lock: false },
    object_m: null,  // the object of the lens diagram; null: 1.5 times the focus distance
  };
}

/** The state with the camera and lens that a scene or a picture asks for. */
export function with_scene(state, opened) {
  const lens = opened.lens ?? {};
  const side = {
    ...first_side(),
    method: state.sides[0].method,
    focus: opened.autofocus ? { at: [0.5, 0.5] } : { m: lens.focus_m ?? 1 },
    focal_length_mm: lens.focal_length_mm ?? 50,
    f_number: lens.f_number ?? 2,
    coc_scale: lens.coc_scale ?? 1,
  };
  const sides = state.sides.map((old) => ({ ...side, dof: old.dof, method: old.method,
                                            samples: old.samples }));
  return { ...state, camera: null, time: 0, object_m: null, sides };
}

/** The state of a picture of that size. It is shown by filters alone, and has no truth. */
export function with_picture(state, { width, height }, methods) {
  const filters = methods.filter(({ kind }) => kind === "filter").map(({ name }) => name);
  return {
    ...state, camera: null, picture: { ...state.picture, size: [width, height] },
    show: ["truth", "error"].includes(state.show) ? "picture" : state.show,
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
    show: state.show === "coc" || state.show === "depth" ? state.show : "picture",
    focus: side.focus,
    focal_length_mm: side.focal_length_mm,
    f_number: side.f_number,
    max_coc_px: side.max_coc_px,
    coc_scale: side.coc_scale,
    samples: side.samples,
    preview,
    hash: hash && preview === 1,
  };
  if (state.camera) request.camera = state.camera;
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
