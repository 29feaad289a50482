import {
  DepthTexture,
  FloatType,
  HalfFloatType,
  Mesh,
  NearestFilter,
  OrthographicCamera,
  PlaneGeometry,
  ShaderMaterial,
  Vector2,
  WebGLRenderTarget,
} from "three";

const kVertexShader = `
  varying vec2 place;
  void main() {
    place = uv;
    gl_Position = vec4(position.xy, 0.0, 1.0);
  }`;

// Eye-dome lighting: what lies behind its neighbours in the picture is darker, which shows shape
// without normals. Source: Boucheny, thesis, Univ. Joseph Fourier, 2009.
const kFragmentShader = `
  uniform sampler2D colours, depths, outlines;
  uniform vec2 texel;
  uniform float near, far, reach, strength, width;
  varying vec2 place;

  float logDepth(vec2 at) {
    float z = texture2D(depths, at).x;
    return log2(near * far / (far - z * (far - near)));
  }
  vec2 around(int k, int n) {
    float angle = 6.2831853 * float(k) / float(n);
    return vec2(cos(angle), sin(angle)) * texel;
  }

  void main() {
    vec4 colour = texture2D(colours, place);
    if (texture2D(depths, place).x < 1.0) {
      float here = logDepth(place), behind = 0.0;
      for (int k = 0; k < 8; ++k)
        behind += min(max(0.0, here - logDepth(place + reach * around(k, 8))), 0.05);
      colour.rgb *= max(exp(-strength * behind), 0.12);
    }

    // An outline is where the drawn thing changes; the topmost of the two gives the ink.
    vec4 mine = texture2D(outlines, place), ink = mine;
    float edge = 0.0;
    for (int k = 0; k < 12; ++k) {
      vec4 other = texture2D(outlines, place + width * around(k, 12));
      if (abs(other.a - mine.a) < 0.002) continue;
      edge += 1.0;
      if (other.a > ink.a) ink = other;
    }
    if (mine.a > 0.006) colour.rgb = mix(colour.rgb, mine.rgb, 0.1);
    colour.rgb = mix(colour.rgb, ink.rgb, smoothstep(0.0, 5.0, edge));

    gl_FragColor = vec4(colour.rgb, 1.0);
    #include <colorspace_fragment>
  }`;

/** Thing `id` in the picture of outlines: 1 has an empty inside, others a tinted one. */
export const outlineMaterial = (id, colour) =>
  new ShaderMaterial({
    uniforms: { colour: { value: colour }, id: { value: (1 + ((id - 1) % 255)) / 255 } },
    vertexShader: `
      void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `
      uniform vec3 colour;
      uniform float id;
      void main() { gl_FragColor = vec4(colour, id); }`,
    side: 2,
  });

/** Puts solid things and outlines together into what is seen. */
export class Picture {
  #renderer;
  #solid = new WebGLRenderTarget(1, 1, {
    type: HalfFloatType,
    samples: 4,
    depthTexture: new DepthTexture(1, 1, FloatType),
  });
  #outlines = new WebGLRenderTarget(1, 1, { minFilter: NearestFilter, magFilter: NearestFilter });
  #material = new ShaderMaterial({
    uniforms: {
      colours: { value: this.#solid.texture },
      depths: { value: this.#solid.depthTexture },
      outlines: { value: this.#outlines.texture },
      texel: { value: new Vector2() },
      near: { value: 1 },
      far: { value: 2 },
      reach: { value: 1.4 },
      strength: { value: 45 },
      width: { value: 2 },
    },
    vertexShader: kVertexShader,
    fragmentShader: kFragmentShader,
    depthTest: false,
    depthWrite: false,
  });
  #quad = new Mesh(new PlaneGeometry(2, 2), this.#material);
  #flat = new OrthographicCamera();

  constructor(renderer) {
    this.#renderer = renderer;
    this.#quad.frustumCulled = false;
  }

  /** width, height  [device pixels] */
  resize(width, height, pixelRatio) {
    this.#solid.setSize(width, height);
    this.#outlines.setSize(width, height);
    this.#material.uniforms.texel.value.set(1 / width, 1 / height);
    this.#material.uniforms.reach.value = 1.1 * pixelRatio;
    this.#material.uniforms.width.value = 1.4 * pixelRatio;
  }

  render(solid, outlined, camera) {
    const { near, far } = this.#material.uniforms;
    near.value = camera.near;
    far.value = camera.far;
    this.#renderer.setRenderTarget(this.#solid);
    this.#renderer.render(solid, camera);
    this.#renderer.setRenderTarget(this.#outlines);
    this.#renderer.setClearColor(0, 0);
    this.#renderer.clear();
    this.#renderer.render(outlined, camera);
    this.#renderer.setRenderTarget(null);
    this.#renderer.render(this.#quad, this.#flat);
  }

  dispose() {
    for (const thing of [this.#solid, this.#outlines, this.#material, this.#quad.geometry]) {
      thing.dispose();
    }
  }
}
