// A camera that goes round the middle of the frame; the z axis stays upright.

const FIELD_OF_VIEW = (30 * Math.PI) / 180;

class Camera {
  /** radius: of the largest frame, nm. */
  constructor(radius) {
    this.radius = radius;
    this.reset();
  }

  /** The view at the start. */
  reset() {
    this.azimuth = -0.6;
    this.elevation = 0.35;
    this.zoom = 1;
    this.shift = [0, 0];
  }

  /** Turn by angles, radians. */
  turn(right, up) {
    this.azimuth -= right;
    const most = Math.PI / 2 - 0.01;
    this.elevation = Math.min(most, Math.max(-most, this.elevation + up));
  }

  /** Come closer by a factor. */
  closer(factor) {
    this.zoom = Math.min(40, Math.max(0.2, this.zoom * factor));
  }

  /** Move what is seen by parts of the height of the picture. */
  move(right, up) {
    const height = 2 * this.distance * Math.tan(FIELD_OF_VIEW / 2);
    this.shift[0] += right * height;
    this.shift[1] += up * height;
  }

  get distance() {
    return (1.08 * this.radius) / Math.sin(FIELD_OF_VIEW / 2) / this.zoom;
  }

  /** Axes of the picture: to the right, up, and towards the viewer. */
  axes() {
    const ca = Math.cos(this.azimuth), sa = Math.sin(this.azimuth);
    const ce = Math.cos(this.elevation), se = Math.sin(this.elevation);
    return [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
  }

  /** Turns and moves the scene before the eye; by columns, as WebGL has it. */
  view() {
    const [right, up, back] = this.axes();
    const columns = [0, 1, 2].flatMap((k) => [right[k], up[k], back[k], 0]);
    return new Float32Array([...columns, this.shift[0], this.shift[1], -this.distance, 1]);
  }

  /** Perspective, for a picture of so much width by height. */
  projection(aspect) {
    // What is narrower than high needs the width.
    const f = Math.min(1, aspect) / Math.tan(FIELD_OF_VIEW / 2);
    const near = Math.max(this.distance - 3 * this.radius, this.distance / 100);
    const far = this.distance + 4 * this.radius;
    return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
                             0, 0, (2 * far * near) / (near - far), 0]);
  }
}

/** Lets a pointer, fingers and the wheel move the camera; `changed` is called after each move. */
function followPointers(canvas, camera, changed) {
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const before = pointers.size === 2 ? spread() : null;
    const now = { x: event.clientX, y: event.clientY };
    pointers.set(event.pointerId, now);
    const height = canvas.clientHeight;
    if (before) {
      const after = spread();
      camera.move((after.x - before.x) / height, (before.y - after.y) / height);
      if (before.size > 0) camera.closer(after.size / before.size);
    } else if (event.buttons & 2 || event.shiftKey) {
      camera.move((now.x - last.x) / height, (last.y - now.y) / height);
    } else {
      camera.turn((4 * (now.x - last.x)) / height, (4 * (now.y - last.y)) / height);
    }
    changed();
  });
  const lift = (event) => pointers.delete(event.pointerId);
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    // Wheels count in lines or pixels.
    const pixels = event.deltaMode === 0 ? event.deltaY : 30 * event.deltaY;
    camera.closer(Math.exp(-0.0015 * pixels));
    changed();
  }, { passive: false });
}
