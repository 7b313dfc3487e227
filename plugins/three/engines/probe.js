// Runs before the scripts of a page. Records what an engine uploads to WebGL 2 textures, and reads the texels back, so
// that one test serves all engines.
(() => {
  const gl2 = WebGL2RenderingContext.prototype;
  const textures = new Map();

  const wrap = (name, before) => {
    const original = gl2[name];
    gl2[name] = function (...args) {
      before(this, args);
      return original.apply(this, args);
    };
  };
  const note = (gl, target, change) => {
    if (target !== gl.TEXTURE_2D) return;
    const texture = gl.getParameter(gl.TEXTURE_BINDING_2D);
    if (texture === null) return;
    if (!textures.has(texture))
      textures.set(texture, { gl, uploaded: new Set(), generated: false, width: 0, height: 0 });
    change(textures.get(texture));
  };
  const upload = (width, height) => (gl, args) =>
    note(gl, args[0], (t) => {
      const level = args[1];
      t.uploaded.add(level);
      if (level === 0 && Number.isInteger(args[width])) Object.assign(t, { width: args[width], height: args[height] });
    });
  wrap('texStorage2D', (gl, [target, , , width, height]) =>
    note(gl, target, (t) => Object.assign(t, { width, height })),
  );
  wrap('texImage2D', (gl, args) => {
    if (args.length < 9)
      return note(gl, args[0], (t) => Object.assign(t, { width: args[5].width, height: args[5].height }));
    if (args[8] !== null) return upload(3, 4)(gl, args);
  });
  wrap('texSubImage2D', upload(4, 5));
  wrap('compressedTexImage2D', upload(3, 4));
  wrap('compressedTexSubImage2D', upload(4, 5));
  wrap('generateMipmap', (gl, [target]) => note(gl, target, (t) => (t.generated = true)));

  const shader = (gl, type, source) => {
    const made = gl.createShader(type);
    gl.shaderSource(made, source);
    gl.compileShader(made);
    return made;
  };

  /**
   * Reads the RGBA bytes of a level, row 0 of the file first. Changes state of the context, so the engine must have
   * finished.
   */
  const read = (gl, texture, width, height, level) => {
    const program = gl.createProgram();
    gl.attachShader(
      program,
      shader(
        gl,
        gl.VERTEX_SHADER,
        `#version 300 es
        void main() { gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0); }`,
      ),
    );
    gl.attachShader(
      program,
      shader(
        gl,
        gl.FRAGMENT_SHADER,
        `#version 300 es
        precision highp float;
        uniform highp sampler2D map;
        uniform int level;
        out vec4 texel;
        void main() { texel = texelFetch(map, ivec2(gl_FragCoord.xy), level); }`,
      ),
    );
    gl.linkProgram(program);
    const target = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
    const framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    for (const state of [
      gl.BLEND,
      gl.CULL_FACE,
      gl.DEPTH_TEST,
      gl.SCISSOR_TEST,
      gl.STENCIL_TEST,
      gl.RASTERIZER_DISCARD,
    ]) {
      gl.disable(state);
    }
    gl.colorMask(true, true, true, true);
    gl.viewport(0, 0, width, height);
    gl.bindVertexArray(null);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.bindSampler(0, null);
    gl.useProgram(program);
    gl.uniform1i(gl.getUniformLocation(program, 'map'), 0);
    gl.uniform1i(gl.getUniformLocation(program, 'level'), level);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const bytes = new Uint8Array(4 * width * height);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    gl.pixelStorei(gl.PACK_ALIGNMENT, 1);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return Array.from(bytes);
  };

  /**
   * Returns, for each texture of `width` x `height` texels, how many levels were uploaded, whether any was generated,
   * and its texels.
   */
  window.probe = ([width, height]) =>
    [...textures]
      .filter(([texture, t]) => t.gl.isTexture(texture) && t.width === width && t.height === height)
      .map(([texture, t]) => {
        const count = 1 + Math.floor(Math.log2(Math.max(t.width, t.height, 1)));
        const size = (level) => [Math.max(1, t.width >> level), Math.max(1, t.height >> level)];
        const levels = Array.from({ length: count }, (_, level) => read(t.gl, texture, ...size(level), level));
        return { width: t.width, height: t.height, generated: t.generated, uploaded: t.uploaded.size, levels };
      });
})();
