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

const kFragmentShader = `
  uniform sampler2D colors, depths, outlines;
  uniform vec2 texel;
  uniform float near, far, pixelRatio, pixelsPerUnit, spacing;
  varying vec2 place;

  float depthAt(vec2 at) {
    float z = texture2D(depths, at).x;
    return near * far / (far - z * (far - near));
  }
  vec2 around(int k, int n) {
    float angle = 6.2831853 * float(k) / float(n);
    return vec2(cos(angle), sin(angle));
  }

  // Shading of points, which have no normals: the slope of the surrounding depth, over a width of
  // the point spacing, replaces the normal. Pairs of neighbors across a depth step are ignored.
  float lightOnPoints(float here) {
    float perPixel = here / pixelsPerUnit;
    float reach = max(2.0 * pixelRatio, spacing / perPixel);
    vec2 slope = vec2(0.0);
    float count = 0.0;
    for (int k = 0; k < 16; ++k) {
      vec2 direction = around(k % 8, 16);
      float pixels = k < 8 ? reach : 0.5 * reach;
      float ahead = depthAt(place + pixels * texel * direction) - here;
      float behind = depthAt(place - pixels * texel * direction) - here;
      if (max(abs(ahead), abs(behind)) > 4.0 * pixels * perPixel + spacing) continue;
      slope += direction * (ahead - behind) / (pixels * perPixel);
      count += 1.0;
    }
    vec3 normal = normalize(vec3(slope / max(count, 1.0), 1.0));
    return 0.25 + 0.85 * max(dot(normal, normalize(vec3(-0.4, 0.6, 1.0))), 0.0);
  }

  // Eye-dome lighting: points behind their neighbors in the picture are darker, which emphasizes
  // edges. Source: Boucheny, thesis, Univ. Joseph Fourier, 2009.
  float lightInTheDome(float here) {
    float behind = 0.0;
    for (int k = 0; k < 8; ++k) {
      float other = depthAt(place + 1.1 * pixelRatio * texel * around(k, 8));
      behind += clamp(log2(here / (other + 0.25 * spacing)), 0.0, 0.05);
    }
    return max(exp(-45.0 * behind), 0.12);
  }

  void main() {
    vec4 color = texture2D(colors, place);
    if (texture2D(depths, place).x < 1.0) {
      float here = depthAt(place);
      color.rgb *= lightInTheDome(here) * mix(lightOnPoints(here), 1.0, color.a);
    }

    // An outline is where the drawn thing changes; the front one of the two gives the color.
    vec4 mine = texture2D(outlines, place), ink = mine;
    float edge = 0.0;
    for (int k = 0; k < 12; ++k) {
      vec4 other = texture2D(outlines, place + 1.4 * pixelRatio * texel * around(k, 12));
      if (abs(other.a - mine.a) < 0.002) continue;
      edge += 1.0;
      if (other.a > ink.a) ink = other;
    }
    if (mine.a > 0.006) color.rgb = mix(color.rgb, mine.rgb, 0.1);
    color.rgb = mix(color.rgb, ink.rgb, smoothstep(0.0, 5.0, edge));

    gl_FragColor = vec4(color.rgb, 1.0);
    #include <colorspace_fragment>
  }`;

/** The material of thing `id` in the outline image: 1 has an empty inside, others a tinted one. */
export const outlineMaterial = (id, color) =>
  new ShaderMaterial({
    uniforms: { color: { value: color }, id: { value: (1 + ((id - 1) % 255)) / 255 } },
    clipping: true,
    vertexShader: `
      #include <clipping_planes_pars_vertex>
      void main() {
        vec4 mvPosition = modelViewMatrix * vec4(position, 1.0);
        #include <clipping_planes_vertex>
        gl_Position = projectionMatrix * mvPosition;
      }`,
    fragmentShader: `
      #include <clipping_planes_pars_fragment>
      uniform vec3 color;
      uniform float id;
      void main() {
        #include <clipping_planes_fragment>
        gl_FragColor = vec4(color, id);
      }`,
    side: 2,
  });

/** Combines solid things and outlines into the final picture. */
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
      colors: { value: this.#solid.texture },
      depths: { value: this.#solid.depthTexture },
      outlines: { value: this.#outlines.texture },
      texel: { value: new Vector2() },
      near: { value: 1 },
      far: { value: 2 },
      pixelRatio: { value: 1 },
      pixelsPerUnit: { value: 1 },
      spacing: { value: 0 },
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

  /** width, height  [device pixels]; pixelRatio  of device pixels to the page's */
  resize(width, height, pixelRatio) {
    this.#solid.setSize(width, height);
    this.#outlines.setSize(width, height);
    this.#material.uniforms.texel.value.set(1 / width, 1 / height);
    this.#material.uniforms.pixelRatio.value = pixelRatio;
  }

  /**
   * solid, outlined  scenes; points of the first have alpha 0, in colors of values more
   * pixelsPerUnit    of something at distance 1
   * spacing          of the points [world]
   */
  render(solid, outlined, camera, pixelsPerUnit, spacing) {
    const { uniforms } = this.#material;
    uniforms.near.value = camera.near;
    uniforms.far.value = camera.far;
    uniforms.pixelsPerUnit.value = pixelsPerUnit;
    uniforms.spacing.value = spacing;
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
