// live.js - opens the live page that is packed in this report, with the scene of the button that was pressed.

const say = (section, words) => { section.querySelector('[role=status]').textContent = words; };

async function unpack() {
    const packed = document.getElementById('live-page').textContent.trim();
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).text();
}

// The page in this section, begun where it is not there yet; it leaves every other section.
async function begin(section) {
    const there = section.querySelector('iframe');
    if (there) return there.contentWindow.shapebench;
    for (const frame of document.querySelectorAll('.live iframe')) frame.remove();
    const frame = Object.assign(document.createElement('iframe'), { title: 'FastLSM and octree, live' });
    frame.srcdoc = await unpack();
    await new Promise((done) => {
        frame.addEventListener('load', done);
        section.append(frame);
    });
    await frame.contentWindow.shapebench.ready;
    frame.contentDocument.getElementById('link').hidden = true; // a report has no address to carry a scene
    return frame.contentWindow.shapebench;
}

async function open(section, name) {
    const page = await begin(section);
    const text = page.engine.sceneText(name);
    return text ? page.open(text, false) : `${name} is not built in: the page has not got it.`;
}

for (const button of document.querySelectorAll('.live button'))
    button.addEventListener('click', async () => {
        const section = button.closest('.live');
        say(section, `Opening ${button.textContent} …`);
        try {
            say(section, await open(section, button.textContent));
        } catch (error) {
            say(section, `The page cannot run here: ${error.message}`);
        }
    });
