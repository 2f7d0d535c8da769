// SPDX-License-Identifier: BSD-3-Clause
// One small shader for all that is drawn. Without a graphics card the shaders of three.js take a
// second to compile, and light computed for each pixel halves the frames.
import { Color, DoubleSide, FrontSide, GLSL3, RawShaderMaterial } from 'three';

const vertexShader = `
in vec3 position, normal, color;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform vec3 cameraPosition, tint;
uniform float twoSided, lit, opacity, rim;
out vec4 shade;
void main() {
  vec4 at = modelMatrix * vec4(position, 1.0);
  vec3 n = mat3(modelMatrix) * normal;
  if (twoSided > 0.5 && dot(n, cameraPosition - at.xyz) < 0.0) n = -n;
  float light = 0.66 + 0.14 * n.z + 0.34 * max(0.0, dot(n, vec3(-0.324, -0.487, 0.811)));
  float across = abs(dot(n, normalize(cameraPosition - at.xyz)));
  shade = vec4((tint + color) * mix(1.0, light, lit), opacity + rim * pow(1.0 - across, 3.0));
  gl_Position = projectionMatrix * viewMatrix * at;
}`;
const fragmentShader = `
precision mediump float;
in vec4 shade;
out vec4 colour;
void main() { colour = shade; }`;

/**
 * A colour for the whole body, or null for the geometry's own. No texture, no shadow; rigid poses
 * only. rim: how much less a body is seen through where it turns away from the camera, which draws
 * the outlines of round bodies.
 */
export function surface(
  colour,
  { opacity = 1, rim = 0, twoSided = false, lit = true, ...settings } = {},
) {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    uniforms: {
      tint: {
        value: colour === null ? [0, 0, 0] : new Color(colour).convertLinearToSRGB().toArray(),
      },
      opacity: { value: opacity },
      rim: { value: rim },
      twoSided: { value: twoSided ? 1 : 0 },
      lit: { value: lit ? 1 : 0 },
    },
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    side: twoSided ? DoubleSide : FrontSide,
    forceSinglePass: true,
    ...settings,
  });
  material.defaultAttributeValues = { color: [0, 0, 0], normal: [0, 0, 1] };
  return material;
}
