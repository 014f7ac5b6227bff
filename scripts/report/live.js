// live.js - opens the live page that is packed in this report, with the scene of the card that was pressed.

const cards = [...document.querySelectorAll('.card')];
const place = document.querySelector('.place'), status = place.querySelector('[role=status]');

async function unpack() {
    const packed = document.getElementById('live-page').textContent.trim();
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).text();
}

// The page, begun where it is not there yet.
async function begin() {
    const there = place.querySelector('iframe');
    if (there) return there.contentWindow.shapebench;
    const frame = Object.assign(document.createElement('iframe'), { title: 'FastLSM and octree, live' });
    frame.srcdoc = await unpack();
    await new Promise((done) => {
        frame.addEventListener('load', done);
        place.append(frame);
    });
    await frame.contentWindow.shapebench.ready;
    frame.contentDocument.getElementById('link').hidden = true; // a report has no address to carry a scene
    return frame.contentWindow.shapebench;
}

async function open(name) {
    const page = await begin();
    const text = page.engine.sceneText(name);
    return text ? page.open(text, false) : `${name} is not built in: the page has not got it.`;
}

cards.forEach((card, n) => {
    card.style.order = 2 * n;
    card.querySelector('button').addEventListener('click', async () => {
        const name = card.querySelector('button').textContent;
        place.style.order = 2 * n + 1; // beneath the card's row, for other cards fill that; moved in the page it began anew
        status.textContent = `Opening ${name} …`;
        place.scrollIntoView({ block: 'nearest' });
        try {
            status.textContent = await open(name);
        } catch (error) {
            status.textContent = `The page cannot run here: ${error.message}`;
        }
        place.scrollIntoView({ block: 'nearest' });
    });
});
