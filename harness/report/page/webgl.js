// ---- WebGL renderer: ground with shadows, lit boxes, lines of a width in pixels.

class WebglRenderer {
  static make(canvas) {
    const gl = canvas.getContext('webgl2', {antialias: true, alpha: true, preserveDrawingBuffer: true});
    return gl ? new WebglRenderer(canvas, gl) : null;
  }

  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    const fade = `
      float fade(vec3 p) { return 1. - smoothstep(.45, 1., length(p.xy - uCentre.xy) / uReach); }`;
    this.boxes = this.program(`#version 300 es
      in vec3 aCorner; in vec3 aNormal;
      uniform mat4 uModel, uView; uniform vec3 uHalf;
      out vec3 vLocal, vWorld, vNormal, vLocalNormal;
      void main() {
        vec4 p = uModel * vec4(aCorner, 1.);
        vLocal = aCorner * uHalf; vWorld = p.xyz; vLocalNormal = aNormal;
        vNormal = normalize(mat3(uModel) * (aNormal / uHalf / uHalf));
        gl_Position = uView * p;
      }`, `#version 300 es
      precision highp float;
      in vec3 vLocal, vWorld, vNormal, vLocalNormal;
      uniform vec3 uColour, uEye, uHalf, uLight, uFog; uniform float uKind, uAlpha, uFogReach;
      out vec4 colour;
      void main() {
        vec3 n = normalize(vNormal), a = abs(vLocalNormal), rest = uHalf - abs(vLocal);
        float light = .58 + .36 * max(dot(n, uLight), 0.) + .10 * n.z, edge = 1.;
        if (uKind > .5 && uKind < 1.5) {
          // The corrugated walls of a container between its posts and rails; it fades where it would flicker.
          float along = a.x > .5 ? vLocal.y : vLocal.x, width = fwidth(along) / .28;
          bool frame = (a.x < .5 && rest.x < .16) || (a.y < .5 && rest.y < .16) || (a.z < .5 && rest.z < .14);
          float wave = a.z > .5 ? .35 : 1.;
          if (!frame) light *= 1. - .12 * wave * (.5 + .5 * smoothstep(-.5, .5, cos(6.2832 * along / .28)) * 2. - .5) * clamp(1.4 - 2.5 * width, 0., 1.);
          else light *= .93;
        }
        vec3 lit = uColour * light;
        float d = length(vWorld - uEye);
        colour = vec4(mix(lit, uFog, .55 * smoothstep(.4, 1.6, d / uFogReach)), 1.) * uAlpha;
      }`);
    this.ground = this.program(`#version 300 es
      in vec3 aCorner; uniform mat4 uView; uniform vec3 uCentre; uniform float uReach; out vec3 vWorld;
      void main() { vWorld = vec3(uCentre.xy + aCorner.xy * uReach, uCentre.z); gl_Position = uView * vec4(vWorld, 1.); }`, `#version 300 es
      precision highp float;
      in vec3 vWorld; uniform vec3 uColour, uGrid, uCentre; uniform float uReach, uStep; out vec4 colour; ${fade}
      float grid(float step) { vec2 p = vWorld.xy / step, w = fwidth(p); vec2 d = abs(fract(p - .5) - .5);
        vec2 l = (1. - smoothstep(vec2(0.), w * 1.3, d)) * clamp(1.2 - 4. * w, 0., 1.); return max(l.x, l.y); }
      void main() { float line = max(.45 * grid(uStep), grid(uStep * 5.)); colour = vec4(mix(uColour, uGrid, line), 1.) * fade(vWorld); }`);
    this.shadow = this.program(`#version 300 es
      in vec3 aCorner; uniform mat4 uModel, uView; uniform vec3 uLight, uCentre; out vec3 vWorld;
      void main() { vec3 p = (uModel * vec4(aCorner, 1.)).xyz; vWorld = p - uLight * max(p.z - uCentre.z, 0.) / uLight.z;
        gl_Position = uView * vec4(vWorld, 1.); }`, `#version 300 es
      precision highp float;
      in vec3 vWorld; uniform vec3 uColour, uCentre; uniform float uReach; out vec4 colour; ${fade}
      void main() { colour = vec4(uColour, 1.) * fade(vWorld); }`);
    this.lines = this.program(`#version 300 es
      in vec3 aA, aB; in vec4 aShape; in vec4 aColour; uniform mat4 uView; uniform vec2 uSize; uniform float uBias;
      out vec4 vColour; out vec3 vDot;
      void main() {  // aShape: end (0, 1), side (-1, 1), width in pixels, 1 for a dot
        vec4 a = uView * vec4(aA, 1.), b = uView * vec4(aB, 1.);
        float near = 1e-3;
        if (a.w < near && b.w > near) a = mix(a, b, (near - a.w) / (b.w - a.w));
        if (b.w < near && a.w > near) b = mix(b, a, (near - b.w) / (a.w - b.w));
        vec2 d = (b.xy / b.w - a.xy / a.w) * uSize; d = length(d) > 1e-6 ? normalize(d) : vec2(1., 0.);
        vec4 p = aShape.x < .5 ? a : b;
        vec2 offset = vec2(-d.y, d.x) * aShape.y;
        if (aShape.w > .5) offset += d * (aShape.x * 2. - 1.);
        p.xy += offset * aShape.z / uSize * p.w;
        p.z -= uBias * p.w;
        vDot = vec3(aShape.x * 2. - 1., aShape.y, aShape.w); vColour = aColour; gl_Position = p;
      }`, `#version 300 es
      precision highp float;
      in vec4 vColour; in vec3 vDot; out vec4 colour;
      void main() { if (vDot.z > .5 && length(vDot.xy) > 1.) discard; colour = vec4(vColour.rgb, 1.) * vColour.a; }`);

    const vertices = [];
    for (const {corners, normal} of cubeFaces)
      for (const i of [0, 1, 2, 0, 2, 3]) vertices.push(...cubeCorners[corners[i]], ...normal);
    this.cube = this.buffer(vertices);
    this.square = this.buffer([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, 1, 0]);
    this.strip = gl.createBuffer();
    this.light = unit([.42, -.55, 1.15]);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthFunc(gl.LEQUAL);
  }

  program(vertex, fragment) {
    const {gl} = this, program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    const uniforms = {}, attributes = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const {name} = gl.getActiveUniform(program, i);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES); ++i) {
      const {name} = gl.getActiveAttrib(program, i);
      attributes[name] = gl.getAttribLocation(program, name);
    }
    return {program, uniforms, attributes};
  }

  buffer(values) {
    const {gl} = this, buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
    return buffer;
  }

  use({program, uniforms, attributes}, buffer, layout, values) {
    const {gl} = this;
    gl.useProgram(program);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (let i = 0; i < 8; ++i) gl.disableVertexAttribArray(i);
    const stride = 4 * layout.reduce((sum, [, count]) => sum + count, 0);
    let offset = 0;
    for (const [name, count] of layout) {
      const place = attributes[name];
      if (place !== undefined) {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, count, gl.FLOAT, false, stride, offset);
      }
      offset += 4 * count;
    }
    this.set(uniforms, values);
  }

  set(uniforms, values) {
    const {gl} = this;
    for (const [name, value] of Object.entries(values)) {
      const place = uniforms[name];
      if (place === undefined) continue;
      if (typeof value === 'number') gl.uniform1f(place, value);
      else if (value.length === 16) gl.uniformMatrix4fv(place, false, value);
      else if (value.length === 2) gl.uniform2fv(place, value);
      else gl.uniform3fv(place, value);
    }
  }

  // views: [{picture, ghost}], from left to right, seen by one camera.
  draw(views, camera, scene, {groundHeight, reach}) {
    const {gl, canvas} = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.disable(gl.SCISSOR_TEST);
    gl.depthMask(true);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const width = Math.floor(canvas.width / views.length);
    gl.enable(gl.SCISSOR_TEST);
    views.forEach((view, i) => {
      gl.viewport(i * width, 0, width, canvas.height);
      gl.scissor(i * width, 0, width, canvas.height);
      this.drawOne(view, camera, scene, [width, canvas.height], groundHeight, reach);
    });
  }

  drawOne({picture, ghost}, camera, scene, size, groundHeight, reach) {
    const {gl} = this, colours = theme.boxes, view = camera.matrix(size[0] / size[1]), pixel = devicePixelRatio || 1;
    const cubeLayout = [['aCorner', 3], ['aNormal', 3]];
    const centre = [camera.target[0], camera.target[1], groundHeight ?? 0];
    gl.disable(gl.DEPTH_TEST);
    if (groundHeight !== null) {
      const step = reach > 40 ? 2 : reach > 15 ? 1 : .2;
      this.use(this.ground, this.square, [['aCorner', 3]], {uView: view, uCentre: centre, uReach: reach * 3, uStep: step,
        uColour: rgb(colours.ground), uGrid: rgb(colours.grid)});
      gl.drawArrays(gl.TRIANGLES, 0, 6);
      this.use(this.shadow, this.cube, cubeLayout, {uView: view, uCentre: centre, uReach: reach * 3, uLight: this.light, uColour: rgb(colours.shadow)});
      for (const box of picture.boxes) {
        if (box.kind === 'left_out') continue;
        this.set(this.shadow.uniforms, {uModel: boxMatrix(box.X, box.half)});
        gl.drawArrays(gl.TRIANGLES, 0, 36);
      }
    }
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    this.use(this.boxes, this.cube, cubeLayout, {uView: view, uEye: camera.eye, uLight: this.light, uFog: rgb(colours.fog), uFogReach: Math.max(reach * 3, camera.distance)});
    const solid = picture.boxes.filter(box => box.kind !== 'left_out');
    const faint = picture.boxes.filter(box => box.kind === 'left_out');
    for (const [list, alpha] of [[solid, 1], [faint, .25]]) {
      gl.depthMask(alpha === 1);
      for (const box of list) {
        this.set(this.boxes.uniforms, {uModel: boxMatrix(box.X, box.half), uHalf: box.half, uColour: rgb(box.colour),
          uKind: box.kind === 'container' ? 1 : 0, uAlpha: alpha});
        gl.drawArrays(gl.TRIANGLES, 0, 36);
      }
    }
    gl.depthMask(true);
    gl.disable(gl.POLYGON_OFFSET_FILL);

    const strip = [];
    const line = (a, b, wa, wb, c, alpha = 1, dot = 0) => {
      for (const [end, side, w] of [[0, -1, wa], [0, 1, wa], [1, 1, wb], [0, -1, wa], [1, 1, wb], [1, -1, wb]])
        strip.push(...a, ...b, end, side, w * pixel, dot, ...c, alpha);
    };
    const edges = (box, width, c, alpha) => {
      const corners = cubeCorners.map(corner => transform(box.X, corner.map((v, k) => v * box.half[k])));
      for (const [i, j] of cubeEdges) line(corners[i], corners[j], width, width, c, alpha);
    };
    const flush = bias => {
      if (strip.length === 0) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, this.strip);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(strip), gl.DYNAMIC_DRAW);
      this.use(this.lines, this.strip, [['aA', 3], ['aB', 3], ['aShape', 4], ['aColour', 4]], {uView: view, uSize: size, uBias: bias});
      gl.drawArrays(gl.TRIANGLES, 0, strip.length / 14);
      strip.length = 0;
    };
    const edge = rgb(colours.edge);
    for (const box of picture.boxes) edges(box, box.kind === 'left_out' ? .8 : 1, edge, box.kind === 'left_out' ? .5 : .75);
    flush(2e-5);
    for (const l of picture.lines) if (l.casing) line(l.a, l.b, l.width + 1.8, l.width + 1.8, edge);
    flush(0);
    for (const l of picture.lines) line(l.a, l.b, l.width, l.width, l.colour);
    flush(2e-5);
    if (ghost) {
      for (const box of ghost.boxes) edges(box, 2.2, rgb(box.colour), .95);
      for (const l of ghost.lines) line(l.a, l.b, l.width, l.width, l.colour, .8);
      flush(4e-5);
    }
    // Forces act inside of what they push on: they are seen through it.
    gl.disable(gl.DEPTH_TEST);
    const halo = rgb(theme.name === 'dark' ? '#14171a' : '#ffffff'), force = rgb(colours.force);
    for (const [c, more] of [[halo, 2], [force, 0]])
      for (const arrow of picture.arrows) {
        const length = norm(sub(arrow.tip, arrow.p)), head = Math.min(.35, scene.size * .05 / Math.max(length, 1e-9));
        const neck = add(arrow.p, scale(sub(arrow.tip, arrow.p), 1 - head));
        line(arrow.p, neck, 3 + more, 3 + more, c);
        line(neck, arrow.tip, 11 + 2 * more, more / 2, c);
        line(arrow.p, arrow.p, 5 + more, 5 + more, c, 1, 1);
      }
    flush(0);
    gl.enable(gl.DEPTH_TEST);
  }
}
