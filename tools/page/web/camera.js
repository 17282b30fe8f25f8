// The free camera: plain functions on {position_m, target_m, fov_y_degrees}. y is up.

function minus(a, b) { return a.map((x, i) => x - b[i]); }
function plus(a, b, factor = 1) { return a.map((x, i) => x + factor * b[i]); }
function length_of(a) { return Math.hypot(...a); }
function cross_of(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
function unit_of(a) {
  const length = length_of(a) || 1;
  return a.map((x) => x / length);
}
// Six digits hold a millimetre in a kilometre, and fit a link.
function tidy(camera) {
  const round = (x) => Number(x.toFixed(6));
  return { ...camera, position_m: camera.position_m.map(round),
           target_m: camera.target_m.map(round) };
}

const kUp = [0, 1, 0];
const kSteepest = 1.55;  // radians; at pi/2 the picture would turn over

/** Around the target, by angles in radians. */
export function orbited(camera, right, up) {
  const arm = minus(camera.position_m, camera.target_m);
  const radius = length_of(arm);
  const turn = Math.atan2(arm[0], arm[2]) - right;
  const lift = Math.asin(arm[1] / radius);
  // A camera that begins steeper than that may come down, but climb no more.
  const most = Math.max(kSteepest, Math.abs(lift));
  const height = Math.min(most, Math.max(-most, lift + up));
  const flat = radius * Math.cos(height);
  const moved = [flat * Math.sin(turn), radius * Math.sin(height), flat * Math.cos(turn)];
  return tidy({ ...camera, position_m: plus(camera.target_m, moved) });
}

/** A light's place or direction turned about `middle`; to the right as the camera sees it. */
export function turned_light(light, middle, right, up) {
  return orbited({ position_m: light, target_m: middle }, -right, up).position_m;
}

/** Nearer to the target for a factor below 1. The target stays. */
export function dollied(camera, factor) {
  const arm = minus(camera.position_m, camera.target_m);
  const length = Math.max(length_of(arm) * factor, 1e-3);
  return tidy({ ...camera, position_m: plus(camera.target_m, unit_of(arm), length) });
}

/** Back by so many metres, ahead if negative, looking the same way. The target stays as long as it is ahead. */
export function backed(camera, metres) {
  const arm = minus(camera.position_m, camera.target_m);
  const length = length_of(arm);
  const position_m = plus(camera.position_m, unit_of(arm), metres);
  const target_m = length + metres > 0.01 * length ? camera.target_m : plus(camera.target_m, unit_of(arm), metres);
  return tidy({ ...camera, position_m, target_m });
}

/** Eye and target together, in metres: to the right, upwards, ahead. */
export function walked(camera, right, up, ahead) {
  const forward = unit_of(minus(camera.target_m, camera.position_m));
  const side = unit_of(cross_of(forward, kUp));
  const step = plus(plus(plus([0, 0, 0], side, right), kUp, up), forward, ahead);
  return tidy({ ...camera, position_m: plus(camera.position_m, step),
                target_m: plus(camera.target_m, step) });
}

/** Along the picture's own axes, by parts of its height at the target's distance. */
export function panned(camera, right, up) {
  const forward = minus(camera.target_m, camera.position_m);
  const height = 2 * length_of(forward) * Math.tan(camera.fov_y_degrees * Math.PI / 360);
  const side = unit_of(cross_of(forward, kUp));
  const top = unit_of(cross_of(side, forward));
  const step = plus(plus([0, 0, 0], side, right * height), top, up * height);
  return tidy({ ...camera, position_m: plus(camera.position_m, step),
                target_m: plus(camera.target_m, step) });
}

export function arm_length_m(camera) {
  return length_of(minus(camera.position_m, camera.target_m));
}
