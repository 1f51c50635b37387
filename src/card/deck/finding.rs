//! What a deck has otherwise than the test: findings that stand in its head and on the terminal.

use base::findings;
use base::number::significant;

findings! {
    /// Something that the test has and the deck does not, or has otherwise.
    #[derive(Clone, Debug, PartialEq)]
    pub enum DeckLoss {
        Mounting {
            time: f64, "that it takes, s" => "time_s";
        } = "deck-mounting", Note;
            meaning "pre-strain is not written as a stress: a first step moves film from its stress-free shape to the frame";
            remedy "subtract its time from that of the solver before signals are compared";
            message "times of the test are those of the solver less {} s of mounting", significant(*time, 6);
        MountingRate {
            time: f64, "of the motion, s" => "time_s";
        } = "deck-mounting-rate", Note;
            meaning "the law of the film depends on the strain rate or relaxes, so that its stress at the frame depends on how fast it \
                is mounted";
            remedy "compare the stress of the film at the beginning of the test, or write the curves of one rate with `--rate`";
            message "the stress of mounted film is that of a law that depends on time, after a motion of {} s", significant(*time, 6);
        Part {
            copies: f64, "of the part in the whole" => "copies";
        } = "deck-part", Note;
            meaning "the deck has the part of the film beside mirror planes, and the share of the body's mass that belongs to it";
            remedy "multiply forces and energies by the number of copies; motion is that of the whole";
            message "the computed part is 1/{copies} of the whole: forces and energies are multiplied by {copies}";
        Bars = "deck-bars", Warning;
            meaning "the bars of the frame, over which film bends, are not in the deck";
            remedy "compare with a scenario without `frame.bars`, or add them as rigid bodies";
            message "lost: the bars of the frame";
        Clamp = "deck-clamp", Warning;
            meaning "film slips in the clamp of the test and is fixed in the deck";
            remedy "compare with a scenario without `frame.clamp`";
            message "lost: film that slips in the clamp";
        Springs = "deck-springs", Warning;
            meaning "film hangs on springs in the test, and its edges are fixed in the deck";
            remedy "compare with a scenario without `frame.springs`, or add them as discrete elements";
            message "lost: the springs between film and frame";
        Air = "deck-air", Warning;
            meaning "the air around the film is not in the deck";
            remedy "compare with a scenario without `air`";
            message "lost: the air around the film";
        FilmContact = "deck-film-contact", Warning;
            meaning "film meets film in the test and passes through it in the deck, where no body presses faces on each other";
            remedy "compare with a scenario without `contact.film` and `contact.itself`, or add a contact between the parts";
            message "lost: contact of film with film";
        BodyContact = "deck-body-contact", Warning;
            meaning "impactors meet each other in the test and pass through each other in the deck";
            remedy "add a contact between them";
            message "lost: contact between impactors";
        GuideFriction = "deck-guide-friction", Warning;
            meaning "the guide of the impactor has friction in the test and none in the deck";
            remedy "compare with a scenario without `guide_friction`";
            message "lost: friction of the guide";
        Spin = "deck-spin", Warning;
            meaning "an impactor spins at the start of the test and not in the deck";
            remedy "add its angular velocity";
            message "lost: spin of an impactor";
        Settling = "deck-settling", Warning;
            meaning "film of the test is brought to equilibrium with its weight before the impact, that of the deck is not: slack film \
                sags, by 1.2 mm in ASTM D1709 (method A), and the impactor of the deck travels as much further";
            remedy "compare with a scenario without `settle`";
            message "lost: equilibrium of the film with its weight before the test";
        Cuts = "deck-cuts", Warning;
            meaning "the film of the test has cuts, that of the deck has none";
            remedy "compare with a scenario without `cuts`";
            message "lost: cuts through the film";
        AddedMass = "deck-added-mass", Warning;
            meaning "small elements of the test have added mass, those of the deck have not";
            remedy "scale masses there, or leave `smallest_step` out";
            message "lost: mass added to small elements";
        Damping = "deck-damping", Warning;
            meaning "the film of the test is damped by its mass, that of the deck is not";
            remedy "add mass-proportional damping, or compare with a scenario without `damping`";
            message "lost: mass-proportional damping of the film";
        Facets {
            depth: f64, "largest distance of facets below the surface, m" => "depth_m";
        } = "deck-facets", Note;
            meaning "the surface of an impactor is written as triangles, whose corners are on it";
            remedy "nothing, while the depth is small beside the elements of film";
            message "facets of impactors are up to {} mm below their surface", significant(1e3 * depth, 3);
        Penalty {
            inset: f64, "of the mesh of impactors below their surface, m" => "inset_m";
        } = "deck-penalty", Note;
            meaning "contact is a penalty there: the mesh of an impactor is smaller, and the contact thickness makes up for it, so that \
                thin film cannot pass through it in a step";
            remedy "nothing: contact begins where it does in the test";
            message "meshes of impactors are {} mm below their surface, and contacts as much thicker", significant(1e3 * inset, 4);
        ContactStiffness {
            stiffness: f64, "of a node, N/m" => "stiffness_n_per_m";
        } = "deck-contact-stiffness", Note;
            meaning "the penalty stiffness of contacts is limited: the solver's own, of the steepest curve of the film, throws stiff film \
                back at first contact";
            remedy "compare with twice the stiffness where film meets a body with more than 10 N a node";
            message "stiffness of contacts is at most {} N/mm a node", significant(1e-3 * stiffness, 3);
        Thickness = "deck-thickness", Note;
            meaning "shells of that solver keep their thickness unless they are told to change it";
            remedy "leave the option, which rubber and plastic film need";
            message "shells change their thickness with the strain (ISTUPD = 1)";
        NotRun {
            solver: &'static str, "whose deck it is" => "solver";
        } = "deck-not-run", Note;
            meaning "no run of that solver has been compared with droptower: what was checked are the fields of the deck";
            remedy "run it, and compare the motion of the impactor";
            message "no run of {solver} has read this deck yet; its fields were checked one by one";
    }
}
