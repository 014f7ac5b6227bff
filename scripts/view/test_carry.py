"""FastLSM's surface by the vertex shader (fastlsm section 4) is that of the processor, and how long both take."""
from page_case import PageCase


class Carry(PageCase):
    def test_the_shader_moves_vertices_as_the_processor_does(self):
        """To the rounding of single precision, in a step of several scenes."""
        for scene, frames, side in (("penguin", 40, 0), ("hand", 20, 0), ("penguins-collide", 10, 0), ("statue-shell", 2, 0),
                                    ("beam-elastic", 20, 1)):
            with self.subTest(scene):
                self.open(scene)
                self.ask("shapebench.advance(values[0])", frames)
                away, turned, times = self.ask(COMPARE, side)
                self.assertLess(away, 1e-5, "of the scene's size")
                self.assertLess(turned, 2e-3)
                print(f"{scene}: {away:.1e} of its size, normals {turned:.1e}; ms by shader {times[0]:.2f}, "
                      f"by processor {times[1]:.2f}", flush=True)

    def test_a_cut_body_is_moved_by_the_processor(self):
        self.open("beam-cut")
        self.assertTrue(self.ask("return shapebench.engine.carried(0) !== null"))
        self.ask("shapebench.advance(150)")
        self.assertGreater(self.figure(0, "broken"), 0)
        self.assertIsNone(self.ask("return shapebench.engine.carried(0)"))
        self.assertIsNone(self.ask("return shapebench.engine.carried(1)"))


COMPARE = """
const { engine } = shapebench, choice = document.getElementById('carrier');
const by = (value) => { choice.value = value; shapebench.showSurface(values[0]); return shapebench.drawn(values[0]); };
const time = (value) => {
    choice.value = value;
    const begin = performance.now();
    for (let i = 0; i < 10; i++) shapebench.showSurface(values[0]);
    shapebench.drawn(values[0]);
    return (performance.now() - begin) / 10;
};
const [one, two] = [by('shader'), by('processor')];
if (one[0].length !== two[0].length || !one[0].length) throw new Error('other vertices');
const size = two[0].reduce((most, x) => Math.max(most, Math.abs(x)), 0);
const most = (a, b) => a.reduce((sum, x, i) => Math.max(sum, Math.abs(x - b[i])), 0);
const times = [time('shader'), time('processor')];
choice.value = 'processor';
return [most(one[0], two[0]) / size, most(one[1], two[1]), times];
"""
