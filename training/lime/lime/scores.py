# SPDX-License-Identifier: LGPL-2.1-or-later
"""Predictions of the networks, and the columns of thesis Table 6.1."""
import math

import cv2
import numpy as np
import torch

from . import encoding

MIN_SHARE = 0.005  # of a picture, that an object has to cover to count: kMinShare of object_tracker.cpp
LOG_CENTERS = torch.log10(torch.tensor(encoding.CENTERS))


def predict(networks, items, device="cpu", true_mask=False):
    """As exported networks would: no code of a layer is below 0 (export.py's ReLU). List of dictionaries, one an item: found
    (probability of the object, 1 × h × w), layer and mirror (linear, gray), diffuse, alpha, bin, log_shininess (of base 10;
    the mean over the bins' probabilities)."""
    networks.eval()
    out = []
    with torch.no_grad():
        for first in range(0, len(items), 25):
            part = items[first:first + 25]
            image = torch.from_numpy(np.stack([i.image for i in part])).float().to(device)
            found = networks.find_mask(image)
            mask = (found > 0.5).float()
            if true_mask:
                mask = torch.from_numpy(np.stack([i.mask for i in part])).float().to(device)
            specular = networks.find_specular(image, mask).clamp(min=0)
            mirror = networks.find_mirror(specular, mask).clamp(min=0) if networks.use_mirror else torch.zeros_like(specular)
            albedo = networks.find_albedo(image, mask, specular).cpu().numpy()
            scores = networks.find_exponent(specular, mirror).cpu()
            if networks.regress:
                logs = scores[:, 0]
                bins = encoding.bin_of(10 ** logs)
            else:
                probabilities = torch.softmax(scores, 1)
                logs, bins = probabilities @ LOG_CENTERS, encoding.choose_bin(probabilities)
            layers, mirrors = (encoding.decode(c).cpu().numpy() for c in (specular, mirror))
            for i in range(len(part)):
                out.append({"found": found[i].cpu().numpy(), "layer": layers[i], "mirror": mirrors[i],
                            "diffuse": albedo[i, :3], "alpha": albedo[i, 3], "bin": int(bins[i]),
                            "log_shininess": float(logs[i])})
    return out


def trivial_layers(item):
    """Specular layers that need no training: none; the smallest channel; what exceeds the 90th percentile."""
    image = item.image_linear
    gray = image.mean(0, keepdims=True)
    bright = np.percentile(gray[item.mask > 0.5], 90)
    return {"zero": np.zeros_like(gray), "smallest channel": image.min(0, keepdims=True),
            "above 90th percentile": np.maximum(gray - bright, 0)}


def code_of(linear):
    """encoding.encode for arrays."""
    return np.log1p(4 * np.maximum(linear, 0)) / 2


def layer_errors(items, layers):
    """Inside the true mask: mean square of the layer clipped at white, that over the truth's mean square (pooled), and
    the mean absolute difference of codes."""
    square = power = code = pixels = 0
    for item, layer in zip(items, layers):
        inside = item.mask > 0.5
        a, b = np.minimum(layer, 1)[inside], np.minimum(item.layer, 1)[inside]
        square += ((a - b) ** 2).mean()
        power += (b ** 2).mean()
        code += np.abs(code_of(layer[inside]) - code_of(item.layer[inside])).mean()
        pixels += 1
    return {"layer_mse": square / pixels, "layer_relative": square / power, "layer_code": code / pixels}


def material_errors(items, bins, logs, diffuse, alphas):
    """Shares of bins that are right and right or next to right; mean squares of m_d, alpha, log10 s and log10 m_s."""
    shininess = torch.tensor([i.shininess for i in items], dtype=torch.float32)
    away = (torch.as_tensor(bins) - encoding.bin_of(shininess)).abs()
    logs = torch.as_tensor(logs, dtype=torch.float32)
    out = {"bin_exact": float((away == 0).float().mean()), "bin_adjacent": float((away <= 1).float().mean()),
           "diffuse_mse": float(np.mean([(a - i.diffuse) ** 2 for a, i in zip(diffuse, items)])),
           "log_shininess_mse": float(((logs - torch.log10(shininess)) ** 2).mean())}
    if items[0].alpha is not None:
        true = torch.tensor([i.alpha for i in items], dtype=torch.float32)
        got = torch.as_tensor(np.array(alphas, np.float32))
        gains = [torch.log10(a.clamp(min=1e-3) * encoding.lobe_gain(s)) for a, s in ((got, 10 ** logs), (true, shininess))]
        out.update(alpha_mse=float(((got - true) ** 2).mean()), log_specular_mse=float(((gains[0] - gains[1]) ** 2).mean()))
    return out


def rendered_error(items, diffuse, alphas):
    """What somebody sees who looks at the object in the albedos that are named, under the true light and of the true shininess:
    mean square, inside the mask, of its difference from the truth in linear light, clipped at white (Eq. 6.4's own measure)."""
    total = 0
    for item, albedo, alpha in zip(items, diffuse, alphas):
        inside = item.mask[0] > 0.5
        shading, layer = item.shading[:, inside], item.layer[:, inside]
        true, named = (np.minimum(a[:, None] * shading + layer * gain, 1)
                       for a, gain in ((item.diffuse, 1), (albedo, alpha / item.alpha)))
        total += ((named - true) ** 2).mean()
    return total / len(items)


def largest_part(mask):
    """Share of the picture that the largest connected part of a mask (h × w) covers."""
    count, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    return max(stats[1:count, cv2.CC_STAT_AREA], default=0) / mask.size


def score(items, predictions):
    """All columns that the items have a truth for. Those without an object have a column of their own: the share in which
    there is one nevertheless."""
    empty = [not i.mask.any() for i in items]
    out = {"count": len(items)}
    if any(empty):
        out["found_in_empty"] = float(np.mean([largest_part(p["found"][0] > 0.5) >= MIN_SHARE
                                               for p, e in zip(predictions, empty) if e]))
    items, predictions = ([a for a, e in zip(list_, empty) if not e] for list_ in (items, predictions))
    if items[0].shininess is not None:
        out.update(material_errors(items, [p["bin"] for p in predictions], [p["log_shininess"] for p in predictions],
                                   [p["diffuse"] for p in predictions], [p["alpha"] for p in predictions]))
    if items[0].layer is not None:
        out.update(layer_errors(items, [p["layer"] for p in predictions]))
    union = [((p["found"] > 0.5) & (i.mask > 0.5)).sum() / max(((p["found"] > 0.5) | (i.mask > 0.5)).sum(), 1)
             for p, i in zip(predictions, items)]
    out["mask_iou"] = float(np.mean(union))
    if items[0].mirror is not None:
        out["mirror_code"] = float(np.mean([
            np.abs(code_of(p["mirror"]) - code_of(i.mirror))[i.mask > 0.5].mean() for p, i in zip(predictions, items)]))
    return out


def baselines(items):
    """Scores of the best constant (each column's own mean or best bin on these very items) and of trivial layers."""
    rows = {}
    if items[0].shininess is not None:
        logs = [math.log10(i.shininess) for i in items]
        diffuse = np.mean([i.diffuse for i in items], 0)
        alpha = np.mean([i.alpha for i in items]) if items[0].alpha is not None else None
        tries = [material_errors(items, [b] * len(items), [np.mean(logs)] * len(items), [diffuse] * len(items),
                                 [alpha] * len(items)) for b in range(encoding.BINS)]
        best = dict(tries[0])
        for column in ("bin_exact", "bin_adjacent"):
            best[column] = max(t[column] for t in tries)
        if alpha is not None:
            gains = encoding.lobe_gain(torch.tensor([i.shininess for i in items])).numpy()
            best["log_specular_mse"] = float(np.log10([i.alpha for i in items] * gains).var())
        rows["constant"] = best
    if items[0].layer is None:
        return rows
    trivial = [trivial_layers(i) for i in items]
    for name in trivial[0]:
        rows[name] = layer_errors(items, [t[name] for t in trivial])
    return rows


def confusion(items, predictions):
    """8 × 8 shares: rows are true bins, columns predicted ones (thesis Fig. 6.7)."""
    table = np.zeros((encoding.BINS, encoding.BINS))
    for item, p in zip(items, predictions):
        table[int(encoding.bin_of(torch.tensor(float(item.shininess)))), p["bin"]] += 1
    return table / np.maximum(table.sum(1, keepdims=True), 1)
